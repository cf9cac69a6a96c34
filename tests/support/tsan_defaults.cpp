// Linked into the tests that use gRPC. Debian's libraries are built without the thread sanitizer, which
// therefore misunderstands what they do in libc; see also tsan_ignore.txt. Without the sanitizer nothing
// calls this function.
extern "C" const char* __tsan_default_options() { return "ignore_noninstrumented_modules=1"; }
