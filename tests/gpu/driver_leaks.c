// Linked into every test that opens a device, so that LeakSanitizer reports leaks of this program
// and not those of drivers. Without a sanitizer it does nothing.
#ifdef __has_feature
#define HAS_ASAN_FEATURE __has_feature(address_sanitizer)
#else
#define HAS_ASAN_FEATURE 0
#endif

#if defined __SANITIZE_ADDRESS__ || HAS_ASAN_FEATURE

// LeakSanitizer calls this function by its name.
const char *__lsan_default_suppressions(void);
const char *__lsan_default_suppressions(void)
{
    return "leak:libvulkan\n"      // the loader, and Mesa's drivers libvulkan_NAME.so
           "leak:libVkLayer_\n"    // the validation layers
           "leak:libLLVM\n"        // lavapipe's compiler
           "leak:libGLX_nvidia\n"; // NVIDIA's driver
}

// Replaces the C library's function: drivers stay loaded after their instance is destroyed, so that
// the report, made at exit, can attribute addresses to them and finds memory that their globals
// own.
int dlclose(void *handle);
int dlclose(void *handle)
{
    (void)handle;
    return 0;
}

#endif
