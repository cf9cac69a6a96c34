// Options of the thread sanitizer for programs that use gRPC. Debian's libraries are built without this
// sanitizer, so it misinterprets what they do in libc; see also tsan_ignore.txt. Without the sanitizer
// nothing calls this function.
extern "C" const char* __tsan_default_options() { return "ignore_noninstrumented_modules=1"; }

// What gRPC keeps of a message that is being sent goes from one of its threads to another, in a
// std::function of the standard library's that is instrumented. None of our code is called from there.
extern "C" const char* __tsan_default_suppressions() {
  return "race:grpc::internal::CallOpSendMessage::SetFinishInterceptionHookPoint\n";
}
