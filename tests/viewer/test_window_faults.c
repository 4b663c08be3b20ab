// Tests faults of window systems and devices that affect a swapchain, by making calls fail in the
// same ways.
#include "window_fixture.h"

// The calls that are replaced, and how many times each of them will fail.
static struct swapchain_calls real;
static struct {
    VkResult acquire, present, create, capabilities;
    int acquires, presents, creates, capability_reads;
    bool no_area, too_many_images, only_encoding;
} fake;

static VKAPI_ATTR VkResult VKAPI_CALL acquire(VkDevice device, VkSwapchainKHR swapchain,
                                              uint64_t timeout, VkSemaphore semaphore,
                                              VkFence fence, uint32_t *index)
{
    bool fails = fake.acquires > 0;
    fake.acquires -= fails;
    if (fails && fake.acquire != VK_SUBOPTIMAL_KHR)
        return fake.acquire; // no image was acquired
    VkResult result = real.acquire(device, swapchain, timeout, semaphore, fence, index);
    return fails ? fake.acquire : result;
}

static VKAPI_ATTR VkResult VKAPI_CALL present(VkQueue queue, const VkPresentInfoKHR *info)
{
    VkResult result = real.present(queue, info);
    if (fake.presents == 0)
        return result;
    fake.presents--;
    return fake.present;
}

static VKAPI_ATTR VkResult VKAPI_CALL create(VkDevice device, const VkSwapchainCreateInfoKHR *info,
                                             const VkAllocationCallbacks *allocator,
                                             VkSwapchainKHR *out)
{
    if (fake.creates == 0)
        return real.create(device, info, allocator, out);
    fake.creates--;
    return fake.create;
}

static VKAPI_ATTR VkResult VKAPI_CALL capabilities(VkPhysicalDevice device, VkSurfaceKHR surface,
                                                   VkSurfaceCapabilitiesKHR *out)
{
    VkResult result = real.capabilities(device, surface, out);
    if (fake.no_area)
        out->currentExtent = (VkExtent2D){0, 0};
    if (fake.capability_reads == 0)
        return result;
    fake.capability_reads--;
    return fake.capabilities;
}

static VKAPI_ATTR VkResult VKAPI_CALL images(VkDevice device, VkSwapchainKHR swapchain,
                                             uint32_t *count, VkImage *out)
{
    VkResult result = real.images(device, swapchain, count, out);
    if (fake.too_many_images)
        *count = SWAPCHAIN_IMAGES_MAX + 1;
    return result;
}

static VKAPI_ATTR VkResult VKAPI_CALL formats(VkPhysicalDevice device, VkSurfaceKHR surface,
                                              uint32_t *count, VkSurfaceFormatKHR *out)
{
    VkResult result = real.formats(device, surface, count, out);
    for (uint32_t i = 0; fake.only_encoding && i < *count; i++)
        if (out[i].format == VK_FORMAT_B8G8R8A8_UNORM || out[i].format == VK_FORMAT_R8G8B8A8_UNORM)
            out[i].format = VK_FORMAT_B8G8R8A8_SRGB;
    return result;
}

static void replace_calls(struct stage *stage)
{
    struct swapchain_calls *calls = &stage->swapchain.calls;
    real = *calls;
    memset(&fake, 0, sizeof fake);
    calls->acquire = acquire;
    calls->present = present;
    calls->create = create;
    calls->capabilities = capabilities;
    calls->images = images;
    calls->formats = formats;
}

// Draws and presents a picture, and checks that it is visible.
static void check_shown(struct stage *stage, uint32_t seed)
{
    struct err err = {0};
    CHECK(stage_draw(stage, seed, &err) && stage_show(stage, &err), "picture %u: %s", seed,
          err.msg);
    CHECK(stage_shows(stage, seed), "picture %u is not seen", seed);
}

TEST(out_of_date_is_made_anew)
{
    struct stage stage;
    STAGE_OPEN(&stage, .validation = true);
    replace_calls(&stage);
    check_shown(&stage, 0);
    fake.acquire = VK_ERROR_OUT_OF_DATE_KHR;
    fake.acquires = 1;
    check_shown(&stage, 1); // shown by the second attempt
    CHECK(stage.swapchain.recreated == 1, "%u", (unsigned)stage.swapchain.recreated);
    fake.present = VK_ERROR_OUT_OF_DATE_KHR;
    fake.presents = 1;
    check_shown(&stage, 2);
    CHECK(stage.swapchain.recreated == 2, "%u", (unsigned)stage.swapchain.recreated);
    // With two failures this picture is left out, but not the next one.
    struct err err = {0};
    fake.acquires = 2;
    uint64_t shown = stage.swapchain.shown;
    CHECK(stage_draw(&stage, 3, &err) && stage_show(&stage, &err), "%s", err.msg);
    CHECK(stage.swapchain.shown == shown);
    check_shown(&stage, 4);
    stage_close(&stage);
}

// A suboptimal swapchain is recreated once; if that does not help, it is used as it is.
TEST(suboptimal_is_made_anew_once)
{
    struct stage stage;
    STAGE_OPEN(&stage, .validation = true);
    replace_calls(&stage);
    check_shown(&stage, 0);
    fake.present = VK_SUBOPTIMAL_KHR;
    fake.presents = 1;
    check_shown(&stage, 1);
    check_shown(&stage, 2);
    CHECK(stage.swapchain.recreated == 1, "%u", (unsigned)stage.swapchain.recreated);
    fake.acquire = VK_SUBOPTIMAL_KHR;
    fake.acquires = fake.presents = 1000;
    for (uint32_t i = 3; i < 10; i++)
        check_shown(&stage, i);
    CHECK(stage.swapchain.recreated == 2, "%u", (unsigned)stage.swapchain.recreated);
    stage_close(&stage);
}

TEST(late_images_leave_pictures_out)
{
    struct stage stage;
    struct err err = {0};
    STAGE_OPEN(&stage, .validation = true);
    replace_calls(&stage);
    check_shown(&stage, 0);
    fake.acquires = 2;
    for (int i = 0; i < 2; i++) {
        fake.acquire = i ? VK_TIMEOUT : VK_NOT_READY;
        CHECK(stage_draw(&stage, 1, &err) && stage_show(&stage, &err), "%s", err.msg);
    }
    CHECK(stage.swapchain.shown == 1 && stage.swapchain.recreated == 0, "%u",
          (unsigned)stage.swapchain.shown);
    check_shown(&stage, 2);
    stage_close(&stage);
}

// The loss may be detected by any call.
TEST(lost_surfaces_are_made_anew)
{
    struct stage stage;
    STAGE_OPEN(&stage, .validation = true);
    replace_calls(&stage);
    fake.acquire = fake.present = fake.create = fake.capabilities = VK_ERROR_SURFACE_LOST_KHR;
    int *const places[] = {&fake.acquires, &fake.presents, &fake.creates, &fake.capability_reads};
    for (uint32_t i = 0; i < 4; i++) {
        VkSurfaceKHR before = stage.swapchain.surface;
        stage.swapchain.vsync = i % 2; // so that the swapchain is recreated
        *places[i] = 1;
        check_shown(&stage, 2 * i);
        struct err err = {0};
        CHECK(stage_show(&stage, &err), "place %u: %s", i, err.msg);
        CHECK(*places[i] == 0 && stage.swapchain.surface != before, "place %u", i);
        check_shown(&stage, 2 * i + 1);
    }
    stage_close(&stage);
}

// If the window system remains lost, an error is reported, without an endless loop.
TEST(surfaces_that_stay_lost_are_an_error)
{
    struct stage stage;
    struct err err = {0};
    STAGE_OPEN(&stage, .validation = true);
    replace_calls(&stage);
    CHECK(stage_draw(&stage, 0, &err), "%s", err.msg);
    fake.acquire = VK_ERROR_SURFACE_LOST_KHR;
    fake.acquires = 1000;
    int shows = 0;
    while (stage_show(&stage, &err) && shows < 100)
        shows++;
    CHECK(shows < 100 && err.code == ERR_GPU && strstr(err.msg, "surface is lost"), "%d: %s", shows,
          err.msg);
    stage_close(&stage);
}

TEST(windows_without_area_have_no_swapchain)
{
    struct stage stage;
    struct err err = {0};
    STAGE_OPEN(&stage, .validation = true);
    replace_calls(&stage);
    check_shown(&stage, 0);
    fake.no_area = true;
    stage.swapchain.is_stale = true;
    for (int i = 0; i < 3; i++)
        CHECK(stage_show(&stage, &err) && !stage.swapchain.handle, "%s", err.msg);
    fake.no_area = false;
    check_shown(&stage, 1);
    stage_close(&stage);
}

// Surfaces that encode sRGB show encoded values unchanged, bit for bit, also after the window's
// size has changed.
TEST(surfaces_that_encode_get_the_same_bits)
{
    struct stage stage;
    struct err err = {0};
    STAGE_OPEN(&stage, .validation = true);
    replace_calls(&stage);
    fake.only_encoding = true;
    stage.swapchain.is_stale = true;
    check_shown(&stage, 0);
    CHECK(stage.swapchain.format == VK_FORMAT_B8G8R8A8_SRGB, "%d", (int)stage.swapchain.format);
    window_resize(&stage.window, 211, 133);
    while (stage.window.width != 211 && stage_wait(&stage, EVENT_RESIZE))
        ;
    CHECK(stage_size(&stage, 211, 133, &err), "%s", err.msg);
    check_shown(&stage, 1);
    stage_close(&stage);
}

TEST(errors_are_told)
{
    static const VkResult results[] = {VK_ERROR_OUT_OF_DEVICE_MEMORY, VK_ERROR_DEVICE_LOST};
    for (int place = 0; place < 5; place++) {
        VkResult result = results[place % 2];
        struct stage stage;
        struct err err = {0};
        STAGE_OPEN(&stage, .validation = true);
        replace_calls(&stage);
        check_shown(&stage, 0);
        fake.acquire = fake.present = fake.create = fake.capabilities = result;
        stage.swapchain.is_stale = place >= 2;
        fake.acquires = place == 0;
        fake.presents = place == 1;
        fake.creates = place == 2;
        fake.capability_reads = place == 3;
        fake.too_many_images = place == 4;
        const char *words = place == 4 ? "17 images" : place % 2 ? "device lost" : "device memory";
        CHECK(!stage_show(&stage, &err) && err.code == ERR_GPU && strstr(err.msg, words),
              "place %d: %s", place, err.msg);
        CHECK(stage.gpu.lost == (place < 4 && result == VK_ERROR_DEVICE_LOST), "place %d", place);
        stage_close(&stage);
    }
}

// The device is lost at each submission, from the first picture on: an error is reported, and
// everything is destroyed.
TEST(the_device_may_be_lost)
{
    for (uint32_t n = 1, failures = 1; failures; n++) {
        struct stage stage;
        struct err err = {0};
        const struct gpu_params params = {.validation = true, .lose_device_at_submit = n};
        failures = 0;
        bool ok = stage_open(&stage, &params, &err);
        if (!ok && err.code != ERR_GPU) {
            stage_close(&stage);
            SKIP("%s", err.msg);
        }
        for (uint32_t i = 0; ok && i < 3; i++)
            ok = stage_draw(&stage, i, &err) && stage_show(&stage, &err);
        CHECK(ok || (stage.gpu.lost && err.code == ERR_GPU && strstr(err.msg, "device lost")), "%s",
              err.msg);
        // A second call reports the loss again.
        if (!ok && stage.swapchain.surface && stage.screen.is_drawn)
            CHECK(!stage_show(&stage, &err));
        failures += !ok;
        stage_close(&stage);
        REQUIRE(n < 100, "it fails for ever");
    }
}

TEST_MAIN(TEST_CASE(out_of_date_is_made_anew), TEST_CASE(suboptimal_is_made_anew_once),
          TEST_CASE(late_images_leave_pictures_out), TEST_CASE(lost_surfaces_are_made_anew),
          TEST_CASE(surfaces_that_stay_lost_are_an_error),
          TEST_CASE(windows_without_area_have_no_swapchain),
          TEST_CASE(surfaces_that_encode_get_the_same_bits), TEST_CASE(errors_are_told),
          TEST_CASE(the_device_may_be_lost))
