#include "worker/opencl_program.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <set>

namespace penumbra {

namespace {

std::string device_text(cl_device_id device, cl_device_info what) {
  std::size_t size = 0;
  clGetDeviceInfo(device, what, 0, nullptr, &size);
  std::string text(size, '\0');
  clGetDeviceInfo(device, what, size, text.data(), nullptr);
  while (!text.empty() && text.back() == '\0') text.pop_back();
  return text;
}

std::string platform_text(cl_platform_id platform, cl_platform_info what) {
  std::size_t size = 0;
  clGetPlatformInfo(platform, what, 0, nullptr, &size);
  std::string text(size, '\0');
  clGetPlatformInfo(platform, what, size, text.data(), nullptr);
  while (!text.empty() && text.back() == '\0') text.pop_back();
  return text;
}

template <typename T>
T device_value(cl_device_id device, cl_device_info what) {
  T value{};
  clGetDeviceInfo(device, what, sizeof value, &value, nullptr);
  return value;
}

/// An OpenCL source from embedded files.
class SourceText {
 public:
  explicit SourceText(std::span<const EmbeddedFile> files) : files_(files) {}

  /// Appends a file with its includes in place, each file once. OpenCL C knows no lang_cpp.h.
  void append(std::string_view name) {
    if (name == "kernels/lang_cpp.h" || !seen_.insert(name).second) return;
    constexpr std::string_view kInclude = "#include \"";
    for (std::string_view text = text_of(name); !text.empty();) {
      const std::size_t end = std::min(text.find('\n'), text.size() - 1) + 1;
      const std::string_view line = text.substr(0, end);
      text.remove_prefix(end);
      const std::string_view directive = line.substr(std::min(line.find_first_not_of(' '), line.size()));
      if (directive.starts_with(kInclude))
        append(directive.substr(kInclude.size(), directive.rfind('"') - kInclude.size()));
      else
        source_ += line;
    }
  }

  [[nodiscard]] const std::string& text() const { return source_; }

 private:
  [[nodiscard]] std::string_view text_of(std::string_view name) const {
    for (const auto files : {files_, embedded_kernels()})
      if (const auto file = std::ranges::find(files, name, &EmbeddedFile::name); file != files.end())
        return file->text;
    return {};  // a host header under a condition that OpenCL C never meets
  }

  std::span<const EmbeddedFile> files_;
  std::set<std::string_view> seen_;
  std::string source_;
};

bool contains_ignoring_case(const std::string& text, const std::string& part) {
  return std::search(text.begin(), text.end(), part.begin(), part.end(),
                     [](unsigned char a, unsigned char b) { return std::tolower(a) == std::tolower(b); }) !=
         text.end();
}

}  // namespace

std::string opencl_error_text(cl_int code) {
  switch (code) {
    case CL_DEVICE_NOT_AVAILABLE:
      return "CL_DEVICE_NOT_AVAILABLE";
    case CL_MEM_OBJECT_ALLOCATION_FAILURE:
      return "CL_MEM_OBJECT_ALLOCATION_FAILURE (too little device memory)";
    case CL_OUT_OF_RESOURCES:
      return "CL_OUT_OF_RESOURCES";
    case CL_OUT_OF_HOST_MEMORY:
      return "CL_OUT_OF_HOST_MEMORY";
    case CL_BUILD_PROGRAM_FAILURE:
      return "CL_BUILD_PROGRAM_FAILURE";
    default:
      return fmt::format("OpenCL error {}", code);
  }
}

std::vector<OpenClDeviceInfo> list_opencl_devices() {
  std::vector<OpenClDeviceInfo> found;
  cl_uint platform_count = 0;
  if (clGetPlatformIDs(0, nullptr, &platform_count) != CL_SUCCESS) return found;
  std::vector<cl_platform_id> platforms(platform_count);
  clGetPlatformIDs(platform_count, platforms.data(), nullptr);
  for (cl_platform_id platform : platforms) {
    cl_uint device_count = 0;
    if (clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 0, nullptr, &device_count) != CL_SUCCESS) continue;
    std::vector<cl_device_id> devices(device_count);
    clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, device_count, devices.data(), nullptr);
    for (cl_device_id device : devices)
      found.push_back({device, platform_text(platform, CL_PLATFORM_NAME), device_text(device, CL_DEVICE_NAME),
                       (device_value<cl_device_type>(device, CL_DEVICE_TYPE) & CL_DEVICE_TYPE_CPU) != 0,
                       device_value<cl_device_fp_config>(device, CL_DEVICE_DOUBLE_FP_CONFIG) != 0,
                       device_value<cl_uint>(device, CL_DEVICE_MAX_COMPUTE_UNITS),
                       device_value<cl_ulong>(device, CL_DEVICE_GLOBAL_MEM_SIZE),
                       device_value<cl_ulong>(device, CL_DEVICE_MAX_MEM_ALLOC_SIZE)});
  }
  return found;
}

Expected<OpenClDeviceInfo> find_opencl_device(const std::string& wanted) {
  const std::vector<OpenClDeviceInfo> devices = list_opencl_devices();
  if (devices.empty())
    return fail(
        "no OpenCL device; install an OpenCL driver (pocl-opencl-icd runs on any CPU) or use --backend "
        "native");
  std::string known;
  for (const OpenClDeviceInfo& device : devices) {
    const bool matches = wanted.empty() ? device.is_cpu
                                        : contains_ignoring_case(device.name, wanted) ||
                                              contains_ignoring_case(device.platform, wanted);
    if (matches) return device;
    known += fmt::format("\n  {}: {}", device.platform, device.name);
  }
  if (wanted.empty()) return devices.front();
  return fail(fmt::format("no OpenCL device matches '{}'; there are:{}", wanted, known));
}

Expected<ClProgram> compile_opencl(cl_context context, const OpenClDeviceInfo& device, std::string_view file,
                                   std::span<const EmbeddedFile> files, std::uint32_t features, int lanes) {
  cl_int status = CL_SUCCESS;
  SourceText text(files);
  text.append(file);
  const char* source = text.text().c_str();
  ClProgram program(clCreateProgramWithSource(context, 1, &source, nullptr, &status));
  if (status != CL_SUCCESS) return fail("cannot create an OpenCL program: " + opencl_error_text(status));
  const auto width =
      std::clamp(int(device_value<cl_uint>(device.id, CL_DEVICE_NATIVE_VECTOR_WIDTH_FLOAT)), 1, lanes);
  std::string options = fmt::format("-w -DFEATURES={} -DLANES={} -DVECTOR_WIDTH={}", features, lanes, width);
  const auto rounding = device_value<cl_device_fp_config>(device.id, CL_DEVICE_SINGLE_FP_CONFIG);
  if ((rounding & CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT) != 0)
    options += " -cl-fp32-correctly-rounded-divide-sqrt";
  status = clBuildProgram(program.get(), 1, &device.id, options.c_str(), nullptr, nullptr);
  if (status != CL_SUCCESS) {
    std::size_t size = 0;
    clGetProgramBuildInfo(program.get(), device.id, CL_PROGRAM_BUILD_LOG, 0, nullptr, &size);
    std::string log(size, '\0');
    clGetProgramBuildInfo(program.get(), device.id, CL_PROGRAM_BUILD_LOG, size, log.data(), nullptr);
    return fail(fmt::format("{} does not compile on {} ({}) with {}: {}\n{}", file, device.name,
                            device.platform, options, opencl_error_text(status), log.c_str()));
  }
  return program;
}

Expected<ClProgram> compile_kernels(cl_context context, const OpenClDeviceInfo& device,
                                    std::uint32_t features, int lanes) {
  return compile_opencl(context, device, "kernels/opencl.cl", {}, features, lanes);
}

}  // namespace penumbra
