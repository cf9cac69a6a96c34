#include "worker/opencl_program.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <vector>

namespace penumbra {

namespace {

constexpr std::size_t kMostKernels = 64;  // of about 100 kB each

/// An OpenCL source, assembled from embedded files.
class SourceText {
 public:
  explicit SourceText(std::span<const EmbeddedFile> files) : files_(files) {}

  /// Appends a file with its includes inserted, each file once. lang_cpp.h is left out, since OpenCL C does
  /// not use it.
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
    return {};  // a host header, in a conditional that is never true in OpenCL C
  }

  std::span<const EmbeddedFile> files_;
  std::set<std::string_view> seen_;
  std::string source_;
};

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

OpenClSource opencl_source(const OpenClDeviceInfo& device, std::string_view file,
                           std::span<const EmbeddedFile> files, const KernelNeeds& needs, int lanes) {
  SourceText text(files);
  text.append(file);
  cl_uint native_width = 1;
  clGetDeviceInfo(device.id, CL_DEVICE_NATIVE_VECTOR_WIDTH_FLOAT, sizeof native_width, &native_width,
                  nullptr);
  const int width = std::clamp(int(native_width), 1, lanes);
  cl_device_fp_config rounding = 0;
  clGetDeviceInfo(device.id, CL_DEVICE_SINGLE_FP_CONFIG, sizeof rounding, &rounding, nullptr);
  std::string options = fmt::format(
      "-cl-std=CL1.2 -w -DFEATURES={}ul -DFAMILIES={}ul -DLIGHT_KINDS_MASK={}u -DTEXTURE_KINDS_MASK={}u "
      "-DLANES={} "
      "-DVECTOR_WIDTH={}",
      needs.features, needs.families, needs.light_kinds, needs.texture_kinds, lanes, width);
  if ((rounding & CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT) != 0)
    options += " -cl-fp32-correctly-rounded-divide-sqrt";
  return {std::string(file), text.text(), options};
}

Expected<ClProgram> compile_opencl(cl_context context, const OpenClDeviceInfo& device,
                                   const OpenClSource& source) {
  cl_int status = CL_SUCCESS;
  const char* text = source.text.c_str();
  ClProgram program(clCreateProgramWithSource(context, 1, &text, nullptr, &status));
  if (status != CL_SUCCESS) return fail("cannot create an OpenCL program: " + opencl_error_text(status));
  status = clBuildProgram(program.get(), 1, &device.id, source.options.c_str(), nullptr, nullptr);
  if (status == CL_SUCCESS) return program;
  std::size_t size = 0;
  clGetProgramBuildInfo(program.get(), device.id, CL_PROGRAM_BUILD_LOG, 0, nullptr, &size);
  std::string log(size, '\0');
  clGetProgramBuildInfo(program.get(), device.id, CL_PROGRAM_BUILD_LOG, size, log.data(), nullptr);
  return fail(fmt::format("{} does not compile on {} ({}) with {}: {}\n{}", source.name, device.name,
                          device.platform, source.options, opencl_error_text(status), log.c_str()));
}

Expected<ClProgram> compile_opencl(cl_context context, const OpenClDeviceInfo& device, std::string_view file,
                                   std::span<const EmbeddedFile> files, const KernelNeeds& needs, int lanes) {
  return compile_opencl(context, device, opencl_source(device, file, files, needs, lanes));
}

std::filesystem::path default_kernel_cache() { return cache_folder("PENUMBRA_KERNEL_CACHE", "kernels"); }

CheckedCache kernel_cache(std::filesystem::path folder) {
  return {std::move(folder), ".clbin", {.most_files = kMostKernels}};
}

std::string kernel_cache_key(const OpenClDeviceInfo& device, const OpenClSource& source) {
  const std::string parts[] = {source.text, source.options, device.compiler_identity};
  return CheckedCache::key_of(parts);
}

ClProgram cached_program(cl_context context, const OpenClDeviceInfo& device, const OpenClSource& source,
                         const CheckedCache& cache, std::string& note) {
  const std::string key = kernel_cache_key(device, source);
  const CheckedCache::Found found = cache.find(key);
  note = found.note;
  if (!found.bytes) return {};
  const std::size_t size = found.bytes->size();
  const unsigned char* data = found.bytes->data();
  cl_int status = CL_SUCCESS, accepted = CL_SUCCESS;
  ClProgram program(clCreateProgramWithBinary(context, 1, &device.id, &size, &data, &accepted, &status));
  if (status == CL_SUCCESS) status = accepted;
  if (status == CL_SUCCESS)
    status = clBuildProgram(program.get(), 1, &device.id, source.options.c_str(), nullptr, nullptr);
  if (status == CL_SUCCESS) return program;
  cache.remove(key);
  note = fmt::format("{} refused the kernel cache's {} ({}), which was removed", device.name,
                     cache.file_of(key).string(), opencl_error_text(status));
  return {};
}

Expected<void> keep_program(cl_program program, const OpenClDeviceInfo& device, const OpenClSource& source,
                            const CheckedCache& cache) {
  if (!cache.enabled()) return {};
  std::size_t size = 0;
  cl_int status = clGetProgramInfo(program, CL_PROGRAM_BINARY_SIZES, sizeof size, &size, nullptr);
  if (status != CL_SUCCESS || size == 0) return fail(device.name + " gives no binaries");
  std::vector<unsigned char> binary(size);
  unsigned char* data = binary.data();
  status = clGetProgramInfo(program, CL_PROGRAM_BINARIES, sizeof data, &data, nullptr);
  if (status != CL_SUCCESS) return fail(device.name + " gives no binaries: " + opencl_error_text(status));
  return cache.keep(kernel_cache_key(device, source), binary);
}

}  // namespace penumbra
