// Tests the parameters that are chosen for a swapchain, for surfaces of all kinds.
#include "test.h"
#include "viewer/window/swapchain_choose.h"

#define SRGB VK_COLOR_SPACE_SRGB_NONLINEAR_KHR
#define COUNT(list) (sizeof(list) / sizeof((list)[0]))

TEST(formats_that_store_come_before_those_that_encode)
{
    static const VkSurfaceFormatKHR offered[] = {
        {VK_FORMAT_R16G16B16A16_SFLOAT, VK_COLOR_SPACE_EXTENDED_SRGB_LINEAR_EXT},
        {VK_FORMAT_R8G8B8A8_UNORM, VK_COLOR_SPACE_HDR10_ST2084_EXT},
        {VK_FORMAT_B8G8R8A8_SRGB, SRGB},
        {VK_FORMAT_R8G8B8A8_SRGB, SRGB},
        {VK_FORMAT_B8G8R8A8_UNORM, SRGB},
        {VK_FORMAT_R8G8B8A8_UNORM, SRGB},
    };
    // The surface supports the first `count` formats.
    static const VkFormat expected[] = {
        VK_FORMAT_UNDEFINED,      VK_FORMAT_UNDEFINED,     VK_FORMAT_UNDEFINED,
        VK_FORMAT_B8G8R8A8_SRGB,  VK_FORMAT_R8G8B8A8_SRGB, VK_FORMAT_B8G8R8A8_UNORM,
        VK_FORMAT_R8G8B8A8_UNORM,
    };
    for (uint32_t count = 0; count <= COUNT(offered); count++) {
        VkSurfaceFormatKHR chosen = swapchain_choose_format(offered, count);
        CHECK(chosen.format == expected[count] && chosen.colorSpace == SRGB, "%u offered: %d",
              count, (int)chosen.format);
    }
    CHECK(swapchain_twin(VK_FORMAT_B8G8R8A8_SRGB) == VK_FORMAT_B8G8R8A8_UNORM);
    CHECK(swapchain_twin(VK_FORMAT_R8G8B8A8_SRGB) == VK_FORMAT_R8G8B8A8_UNORM);
    CHECK(swapchain_twin(VK_FORMAT_B8G8R8A8_UNORM) == VK_FORMAT_UNDEFINED);
    CHECK(swapchain_twin(VK_FORMAT_D32_SFLOAT) == VK_FORMAT_UNDEFINED);
}

TEST(modes_follow_vsync)
{
    static const VkPresentModeKHR offered[] = {
        VK_PRESENT_MODE_FIFO_KHR, VK_PRESENT_MODE_FIFO_RELAXED_KHR, VK_PRESENT_MODE_IMMEDIATE_KHR,
        VK_PRESENT_MODE_MAILBOX_KHR};
    for (uint32_t count = 0; count <= COUNT(offered); count++) {
        VkPresentModeKHR expected = count ? offered[count - 1] : VK_PRESENT_MODE_FIFO_KHR;
        CHECK(swapchain_choose_mode(offered, count, false) == expected, "%u offered", count);
        CHECK(swapchain_choose_mode(offered, count, true) == VK_PRESENT_MODE_FIFO_KHR);
    }
}

TEST(sizes_are_the_surfaces_own_or_the_windows)
{
    VkSurfaceCapabilitiesKHR surface = {
        .currentExtent = {640, 360},
        .minImageExtent = {16, 16},
        .maxImageExtent = {1000, 800},
    };
    VkExtent2D got = swapchain_choose_extent(&surface, 320, 200);
    CHECK(got.width == 640 && got.height == 360);
    surface.currentExtent = (VkExtent2D){UINT32_MAX, UINT32_MAX};
    got = swapchain_choose_extent(&surface, 320, 200);
    CHECK(got.width == 320 && got.height == 200);
    got = swapchain_choose_extent(&surface, 5, 2000);
    CHECK(got.width == 16 && got.height == 800);
    surface.currentExtent = (VkExtent2D){0, 0}; // minimised
    got = swapchain_choose_extent(&surface, 320, 200);
    CHECK(got.width == 0 && got.height == 0);
}

TEST(counts_leave_an_image_to_draw_on)
{
    static const struct {
        uint32_t least, most;
        VkPresentModeKHR mode;
        uint32_t expected;
    } cases[] = {
        {1, 0, VK_PRESENT_MODE_FIFO_KHR, 2},      {2, 8, VK_PRESENT_MODE_FIFO_KHR, 3},
        {3, 3, VK_PRESENT_MODE_FIFO_KHR, 3},      {1, 0, VK_PRESENT_MODE_MAILBOX_KHR, 3},
        {1, 2, VK_PRESENT_MODE_MAILBOX_KHR, 2},   {4, 0, VK_PRESENT_MODE_MAILBOX_KHR, 5},
        {1, 1, VK_PRESENT_MODE_IMMEDIATE_KHR, 1},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        const VkSurfaceCapabilitiesKHR surface = {
            .minImageCount = cases[i].least,
            .maxImageCount = cases[i].most,
        };
        uint32_t count = swapchain_choose_count(&surface, cases[i].mode);
        CHECK(count == cases[i].expected, "case %zu: %u", i, count);
    }
}

TEST_MAIN(TEST_CASE(formats_that_store_come_before_those_that_encode),
          TEST_CASE(modes_follow_vsync), TEST_CASE(sizes_are_the_surfaces_own_or_the_windows),
          TEST_CASE(counts_leave_an_image_to_draw_on))
