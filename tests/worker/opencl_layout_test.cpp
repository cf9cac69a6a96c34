// Structs that host and device share have the same layout: the device reports its sizes and offsets, and the
// test compares them.
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "kernels/scene_types.h"
#include "worker/opencl_program.h"

namespace penumbra {
namespace {

struct LayoutValue {
  std::string name;
  std::uint32_t value;
};

template <typename Struct>
const Struct& instance() {
  static const Struct object{};
  return object;
}

template <typename Field>
std::uint32_t offset_in(const void* object, const Field* field) {
  return std::uint32_t(reinterpret_cast<std::uintptr_t>(field) - reinterpret_cast<std::uintptr_t>(object));
}

// An array's entry in a field list carries its extents, so its "offset" is that of the element past its last,
// here and on the device alike.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Warray-bounds"
/// In the order of report_layout in kernels/opencl_layout.cl.
#ifdef __clang__
__attribute__((no_sanitize("undefined")))
#endif
std::vector<LayoutValue>
host_layout() {
  std::vector<LayoutValue> layout;
#define LIST_FIELD(type, field) \
  layout.push_back({std::string(name) + "::" #field, offset_in(&object, &object.field)});
#define LIST_STRUCT(struct_name, fields)                                             \
  {                                                                                  \
    const char* name = #struct_name;                                                 \
    const auto& object = instance<struct_name>();                                    \
    layout.push_back({std::string("sizeof ") + name, std::uint32_t(sizeof object)}); \
    fields(LIST_FIELD)                                                               \
  }
  SHARED_STRUCTS(LIST_STRUCT)
#undef LIST_STRUCT
#undef LIST_FIELD
  return layout;
}
#pragma GCC diagnostic pop

TEST(OpenClLayout, IsTheHosts) {
  if (list_opencl_devices().empty()) GTEST_SKIP() << "no OpenCL device on this machine";
  const OpenClDeviceInfo device = *find_opencl_device("");
  cl_int status = CL_SUCCESS;
  const ClContext context(clCreateContext(nullptr, 1, &device.id, nullptr, nullptr, &status));
  ASSERT_EQ(status, CL_SUCCESS);
  const ClQueue queue(clCreateCommandQueue(context.get(), device.id, 0, &status));
  ASSERT_EQ(status, CL_SUCCESS);
  const auto program =
      compile_opencl(context.get(), device, "kernels/opencl_layout.cl", {}, {FEATURE_PATH}, 1);
  ASSERT_TRUE(program) << program.error().message;
  const ClKernel kernel(clCreateKernel(program->get(), "report_layout", &status));
  ASSERT_EQ(status, CL_SUCCESS);

  const std::vector<LayoutValue> expected = host_layout();
  ASSERT_GT(expected.size(), 80u);
  constexpr std::uint32_t kUntouched = 0xdeadbeef;
  std::vector<cl_uint> reported(expected.size() + 1, kUntouched);
  const std::size_t bytes = reported.size() * sizeof(cl_uint);
  const ClBuffer buffer(clCreateBuffer(context.get(), CL_MEM_READ_WRITE | CL_MEM_COPY_HOST_PTR, bytes,
                                       reported.data(), &status));
  ASSERT_EQ(status, CL_SUCCESS);
  cl_mem argument = buffer.get();
  ASSERT_EQ(clSetKernelArg(kernel.get(), 0, sizeof argument, &argument), CL_SUCCESS);
  const std::size_t one = 1;
  ASSERT_EQ(clEnqueueNDRangeKernel(queue.get(), kernel.get(), 1, nullptr, &one, &one, 0, nullptr, nullptr),
            CL_SUCCESS);
  ASSERT_EQ(
      clEnqueueReadBuffer(queue.get(), buffer.get(), CL_TRUE, 0, bytes, reported.data(), 0, nullptr, nullptr),
      CL_SUCCESS);
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_EQ(reported[i], expected[i].value) << expected[i].name;
  EXPECT_EQ(reported.back(), kUntouched) << "the device reports more than there is";
}

}  // namespace
}  // namespace penumbra
