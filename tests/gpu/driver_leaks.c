// Linked into every test that opens a device, so that LeakSanitizer finds our leaks and not the
// drivers'. Nothing without a sanitizer.
#ifdef __has_feature
#define HAS_ASAN_FEATURE __has_feature(address_sanitizer)
#else
#define HAS_ASAN_FEATURE 0
#endif

#if defined __SANITIZE_ADDRESS__ || HAS_ASAN_FEATURE

// LeakSanitizer calls it by this name.
const char *__lsan_default_suppressions(void);
const char *__lsan_default_suppressions(void)
{
    return "leak:libvulkan\n"      // the loader, and Mesa's drivers libvulkan_NAME.so
           "leak:libVkLayer_\n"    // the validation layers
           "leak:libLLVM\n"        // lavapipe's compiler
           "leak:libGLX_nvidia\n"; // NVIDIA's driver
}

// Takes the place of the C library's: a driver stays loaded after its instance is gone, so that the
// report, made at exit, knows whose code the addresses are, and reaches what its globals hold.
int dlclose(void *handle);
int dlclose(void *handle)
{
    (void)handle;
    return 0;
}

#endif
