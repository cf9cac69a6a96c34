#include "worker/opencl_devices.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstdlib>
#include <mutex>

#include "kernels/features.h"
#include "kernels/host/text.h"

namespace penumbra {
namespace {

template <typename Object, typename Query>
std::string text_of(Object object, cl_uint what, Query query) {
  std::size_t size = 0;
  if (query(object, what, 0, nullptr, &size) != CL_SUCCESS) return {};
  std::string text(size, '\0');
  query(object, what, size, text.data(), nullptr);
  while (!text.empty() && text.back() == '\0') text.pop_back();
  return text;
}
std::string text_of(cl_device_id device, cl_device_info what) {
  return text_of(device, what, clGetDeviceInfo);
}
std::string text_of(cl_platform_id platform, cl_platform_info what) {
  return text_of(platform, what, clGetPlatformInfo);
}

template <typename T>
T value_of(cl_device_id device, cl_device_info what) {
  T value{};
  clGetDeviceInfo(device, what, sizeof value, &value, nullptr);
  return value;
}

OpenClDeviceInfo describe(cl_platform_id platform, cl_device_id device) {
  OpenClDeviceInfo info;
  info.id = device;
  info.platform = text_of(platform, CL_PLATFORM_NAME);
  info.name = text_of(device, CL_DEVICE_NAME);
  info.is_cpu = (value_of<cl_device_type>(device, CL_DEVICE_TYPE) & CL_DEVICE_TYPE_CPU) != 0;
  info.has_double = value_of<cl_device_fp_config>(device, CL_DEVICE_DOUBLE_FP_CONFIG) != 0;
  info.compute_units = std::max(1u, value_of<cl_uint>(device, CL_DEVICE_MAX_COMPUTE_UNITS));
  info.memory_bytes = value_of<cl_ulong>(device, CL_DEVICE_GLOBAL_MEM_SIZE);
  info.max_allocation_bytes = value_of<cl_ulong>(device, CL_DEVICE_MAX_MEM_ALLOC_SIZE);
  constexpr cl_device_fp_config kExact =
      CL_FP_DENORM | CL_FP_INF_NAN | CL_FP_ROUND_TO_NEAREST | CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT;
  info.is_exact = (value_of<cl_device_fp_config>(device, CL_DEVICE_SINGLE_FP_CONFIG) & kExact) == kExact;
  info.limits_registers = text_of(device, CL_DEVICE_EXTENSIONS).contains("cl_nv_compiler_options");
  info.version = text_of(device, CL_DEVICE_VERSION);
  for (const cl_platform_info what : {CL_PLATFORM_NAME, CL_PLATFORM_VENDOR, CL_PLATFORM_VERSION})
    info.compiler_identity += text_of(platform, what) + "\n";
  for (const cl_device_info what :
       {CL_DEVICE_NAME, CL_DEVICE_VENDOR, CL_DEVICE_VERSION, CL_DRIVER_VERSION, CL_DEVICE_OPENCL_C_VERSION})
    info.compiler_identity += text_of(device, what) + "\n";
  return info;
}

/// Whether the device has OpenCL 1.2 or later, and a compiler.
bool runs_our_kernels(cl_device_id device) {
  const std::string version = text_of(device, CL_DEVICE_VERSION);
  int major = 0, minor = 0;
  constexpr std::size_t kDigits = 7;  // after "OpenCL "
  if (version.size() < kDigits + 3) return false;
  const char* end = version.data() + version.size();
  const auto [dot, error] = std::from_chars(version.data() + kDigits, end, major);
  if (error != std::errc() || dot == end) return false;
  std::from_chars(dot + 1, end, minor);
  return (major > 1 || minor >= 2) && value_of<cl_bool>(device, CL_DEVICE_AVAILABLE) != 0 &&
         value_of<cl_bool>(device, CL_DEVICE_COMPILER_AVAILABLE) != 0;
}

/// PoCL compiles a kernel for the size of its launch, and again for any size when its binary is requested for
/// the cache. For kernels of one work item this is twice the work. With this variable it only does the
/// latter, unless the user has set it. Other drivers ignore it.
void ask_for_one_compilation() { setenv("POCL_WORK_GROUP_SPECIALIZATION", "0", 0); }

bool contains_ignoring_case(const std::string& text, const std::string& part) {
  return std::search(text.begin(), text.end(), part.begin(), part.end(),
                     [](unsigned char a, unsigned char b) { return std::tolower(a) == std::tolower(b); }) !=
         text.end();
}

}  // namespace

std::vector<OpenClDeviceInfo> list_opencl_devices() {
  static std::once_flag asked;
  std::call_once(asked, ask_for_one_compilation);
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
      if (runs_our_kernels(device)) found.push_back(describe(platform, device));
  }
  return found;
}

Expected<OpenClDeviceInfo> find_opencl_device(const std::string& wanted) {
  const std::vector<OpenClDeviceInfo> devices = list_opencl_devices();
  if (devices.empty())
    return fail(
        "no OpenCL device; install an OpenCL driver (pocl-opencl-icd runs on any CPU) or use --backend "
        "native");
  if (wanted.empty()) {
    const auto cpu = std::ranges::find_if(devices, &OpenClDeviceInfo::is_cpu);
    return cpu != devices.end() ? *cpu : devices.front();
  }
  std::size_t number = 0;
  const char* end = wanted.data() + wanted.size();
  const auto [rest, error] = std::from_chars(wanted.data(), end, number);
  if (error == std::errc() && rest == end && number < devices.size()) return devices[number];
  for (const OpenClDeviceInfo& device : devices)
    if (contains_ignoring_case(device.name, wanted) || contains_ignoring_case(device.platform, wanted))
      return device;
  return fail(fmt::format("no OpenCL device matches '{}', by number or part of a name; there are:\n{}",
                          wanted, opencl_device_table(devices)));
}

std::vector<OpenClDeviceInfo> suitable_opencl_devices(std::uint64_t features) {
  std::vector<OpenClDeviceInfo> devices = list_opencl_devices();
  std::erase_if(devices, [features](const OpenClDeviceInfo& device) {
    return device.is_cpu || !device.is_exact || !lacking_for(device, features).empty();
  });
  return devices;
}

std::string lacking_for(const OpenClDeviceInfo& device, std::uint64_t features) {
  if ((features & (FEATURE_POLYGONS | FEATURE_PROJECTED)) == 0u || device.has_double) return {};
  return device.name +
         " has no double precision (cl_khr_fp64), which closed forms and projected solid angles of polygon "
         "lights need";
}

std::string opencl_device_table(const std::vector<OpenClDeviceInfo>& devices) {
  std::string table;
  for (std::size_t i = 0; i < devices.size(); ++i) {
    const OpenClDeviceInfo& device = devices[i];
    table += fmt::format("{}  {}: {} ({}, {}, {:.1f} GB{}{})", i, device.platform, device.name,
                         device.is_cpu ? "CPU" : "no CPU", counted(device.compute_units, "unit"),
                         double(device.memory_bytes) * 1e-9, device.has_double ? ", double precision" : "",
                         device.is_exact ? "" : ", inexact float arithmetic");
    if (i + 1 < devices.size()) table += '\n';
  }
  return table;
}

}  // namespace penumbra
