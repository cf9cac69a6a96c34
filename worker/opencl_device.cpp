#include "worker/opencl_device.h"

#include <fmt/format.h>

#include <algorithm>

#include "kernels/unit.h"
#include "worker/opencl_program.h"

namespace penumbra {
namespace {

struct BlockShape {
  int lanes;
  int paths;  ///< under way at once in a work item
};
// A CPU vectorises lane loops inside a work item; a GPU runs a work item a lane.
constexpr BlockShape kCpuShape{16, 4096 + 16};
constexpr BlockShape kGpuShape{1, 1};
constexpr int kSlots = 4096 + 16;   // stride of a CPU block's samples; no power of two, for the cache's sake
constexpr int kGpuItems = 1 << 14;  // work items of one launch on a GPU, a pixel each

class OpenClDevice final : public Device {
 public:
  static Expected<std::unique_ptr<Device>> make(const DeviceScene& scene, const DeviceOptions& options) {
    if (scene.header.intersector == INTERSECTOR_EMBREE)
      return fail(
          "OpenCL kernels trace with the portable intersector; use --intersector portable with --backend "
          "opencl");
    Expected<OpenClDeviceInfo> info = find_opencl_device(options.opencl_device);
    if (!info) return std::unexpected(info.error());
    std::unique_ptr<OpenClDevice> device(new OpenClDevice(*info));
    if (Expected<void> done = device->set_up(scene, options.threads); !done)
      return std::unexpected(done.error());
    return device;
  }

  /// Nothing may be under way when buffers and queue go: PoCL crashes otherwise.
  ~OpenClDevice() override {
    if (queue_) clFinish(queue_.get());
  }

  std::string description() const override {
    return fmt::format("OpenCL {} ({}), features {:#x}, {} work items", info_.name, info_.platform, features_,
                       items_);
  }

  Expected<SampleBuffer> render(const RenderUnit& unit) override {
    Expected<SampleBuffer> made = make_sample_buffer(unit, features_);
    if (!made) return made;
    SampleBuffer& result = *made;
    if (Expected<void> ready = reserve(unit, result.values.size() * sizeof(float)); !ready)
      return std::unexpected(ready.error());

    const int pixels = int(result.pixels());
    const int samples = int(unit.sample_count);
    // As few pixels a block as keep every work item busy, as many as a block's samples allow.
    const int share = (pixels + items_ - 1) / items_;
    const int block_pixels =
        info_.is_cpu ? std::max(1, std::min(int(kMaxSamplesPerUnit) / samples, share)) : 1;
    for (int first = 0; first < pixels; first += block_pixels * items_) {
      const int left = (pixels - first + block_pixels - 1) / block_pixels;
      const std::size_t global = std::size_t(std::min(items_, left)), local = 1;
      set_arguments(unit, first, block_pixels);
      const cl_int status = clEnqueueNDRangeKernel(queue_.get(), kernel_.get(), 1, nullptr, &global,
                                                   info_.is_cpu ? &local : nullptr, 0, nullptr, nullptr);
      if (status != CL_SUCCESS)
        return fail("cannot launch a kernel on " + info_.name + ": " + opencl_error_text(status));
      // Counters are per work item and launch: read before the next launch reuses them.
      std::vector<BadSamples> bad(BAD_KINDS * global);
      if (Expected<void> read_back = read(bad_.get(), bad.data(), bad.size() * sizeof(BadSamples));
          !read_back)
        return std::unexpected(read_back.error());
      const Unit portable{unit.x, unit.y, unit.width, unit.height, unit.first_sample, samples};
      for (std::size_t i = 0; i < bad.size(); i += BAD_KINDS) {
        result.nan.add(non_finite_samples(portable, bad[i + BAD_NAN]));
        result.infinite.add(non_finite_samples(portable, bad[i + BAD_INFINITE]));
      }
      if (std::ranges::any_of(bad, [](const BadSamples& noted) { return noted.count != 0; }))
        clear_counters();
    }
    if (Expected<void> read_back =
            read(out_.get(), result.values.data(), result.values.size() * sizeof(float));
        !read_back)
      return std::unexpected(read_back.error());
    return made;
  }

 private:
  explicit OpenClDevice(OpenClDeviceInfo info)
      : info_(std::move(info)), shape_(info_.is_cpu ? kCpuShape : kGpuShape) {}

  Expected<void> set_up(const DeviceScene& scene, int threads) {
    cl_int status = CL_SUCCESS;
    const cl_device_id device = info_.id;
    context_.reset(clCreateContext(nullptr, 1, &device, nullptr, nullptr, &status));
    if (status != CL_SUCCESS) return fail("cannot use " + info_.name + ": " + opencl_error_text(status));
    queue_.reset(clCreateCommandQueue(context_.get(), device, 0, &status));
    if (status != CL_SUCCESS) return fail("cannot use " + info_.name + ": " + opencl_error_text(status));
    // Context and queue live as long as the process: a thread of PoCL 3.1 may still be releasing the last
    // command's event, which uses both, when the wait for that command has returned.
    clRetainContext(context_.get());
    clRetainCommandQueue(queue_.get());
    features_ = scene.header.features;
    if ((features_ & (FEATURE_POLYGONS | FEATURE_PROJECTED)) != 0u && !info_.has_double)
      return fail(
          info_.name +
          " has no double precision, which closed forms and projected solid angles of polygon lights need");
    Expected<ClProgram> program = compile_kernels(context_.get(), info_, features_, shape_.lanes);
    if (!program) return std::unexpected(program.error());
    program_ = std::move(*program);
    kernel_.reset(clCreateKernel(program_.get(), "render_blocks", &status));
    if (status != CL_SUCCESS) return fail("cannot create the kernel: " + opencl_error_text(status));
    // A CPU device runs a work item a core, so this many keep that many cores busy. (Dividing the device
    // would say so more plainly, but PoCL 3.1 crashes on sub-devices.)
    items_ = info_.is_cpu ? std::max(1, threads) : kGpuItems;
    if (Expected<void> done = upload(header_, &scene.header, sizeof scene.header); !done) return done;
    return upload(words_, scene.words.data(), scene.words.size() * 4);
  }

  Expected<void> upload(ClBuffer& buffer, const void* data, std::size_t bytes) {
    cl_int status = CL_SUCCESS;
    buffer.reset(clCreateBuffer(context_.get(), CL_MEM_READ_ONLY | CL_MEM_COPY_HOST_PTR,
                                std::max<std::size_t>(bytes, 4), const_cast<void*>(data), &status));
    if (status != CL_SUCCESS)
      return fail(fmt::format("cannot copy {} bytes of the scene to {}: {}", bytes, info_.name,
                              opencl_error_text(status)));
    return {};
  }

  Expected<void> allocate(ClBuffer& buffer, std::size_t bytes) {
    cl_int status = CL_SUCCESS;
    buffer.reset(clCreateBuffer(context_.get(), CL_MEM_READ_WRITE, bytes, nullptr, &status));
    if (status != CL_SUCCESS)
      return fail(
          fmt::format("cannot allocate {} bytes on {}: {}", bytes, info_.name, opencl_error_text(status)));
    const cl_uint zero = 0;  // lanes that no path ever used hold numbers too
    clEnqueueFillBuffer(queue_.get(), buffer.get(), &zero, sizeof zero, 0, bytes / 4 * 4, 0, nullptr,
                        nullptr);
    return {};
  }

  /// Block memory for units of this many samples, and the result's.
  Expected<void> reserve(const RenderUnit& unit, std::size_t out_bytes) {
    const int slots = info_.is_cpu ? kSlots : int(unit.sample_count);
    if (slots > slots_) {
      slots_ = slots;
      const std::size_t paths = std::size_t(items_) * std::size_t(shape_.paths);
      for (auto [buffer, bytes] : {std::pair{&floats_, paths * std::size_t(state_floats(features_)) * 4},
                                   std::pair{&ints_, paths * STATE_INTS * 4},
                                   std::pair{&slot_memory_, std::size_t(items_) * std::size_t(slots) *
                                                                std::size_t(slot_floats(features_)) * 4},
                                   std::pair{&bad_, std::size_t(items_) * sizeof(BadSamples) * BAD_KINDS}})
        if (Expected<void> done = allocate(*buffer, bytes); !done) return done;
    }
    if (out_bytes > out_bytes_) {
      if (Expected<void> done = allocate(out_, out_bytes); !done) return done;
      out_bytes_ = out_bytes;
    }
    return {};
  }

  void clear_counters() {
    const cl_uint zero = 0;
    clEnqueueFillBuffer(queue_.get(), bad_.get(), &zero, sizeof zero, 0,
                        std::size_t(items_) * sizeof(BadSamples) * BAD_KINDS, 0, nullptr, nullptr);
  }

  void set_arguments(const RenderUnit& unit, int first_pixel, int block_pixels) {
    cl_uint at = 0;
    const auto set = [&](const auto& value) { clSetKernelArg(kernel_.get(), at++, sizeof value, &value); };
    const auto set_buffer = [&](const ClBuffer& buffer) { set(static_cast<cl_mem>(buffer.get())); };
    set_buffer(header_);
    set_buffer(words_);
    for (int value : {unit.x, unit.y, unit.width, unit.height, int(unit.first_sample), int(unit.sample_count),
                      first_pixel, block_pixels, shape_.paths, slots_})
      set(value);
    for (const ClBuffer* buffer : {&floats_, &ints_, &slot_memory_, &out_, &bad_}) set_buffer(*buffer);
  }

  Expected<void> read(cl_mem buffer, void* to, std::size_t bytes) {
    const cl_int status =
        clEnqueueReadBuffer(queue_.get(), buffer, CL_TRUE, 0, bytes, to, 0, nullptr, nullptr);
    if (status != CL_SUCCESS)
      return fail("cannot read back from " + info_.name + ": " + opencl_error_text(status));
    return {};
  }

  OpenClDeviceInfo info_;
  BlockShape shape_;
  int items_ = 1, slots_ = 0;
  std::size_t out_bytes_ = 0;
  std::uint32_t features_ = 0;
  ClContext context_;
  ClQueue queue_;
  ClProgram program_;
  ClKernel kernel_;
  ClBuffer header_, words_, floats_, ints_, slot_memory_, out_, bad_;
};

}  // namespace

Expected<std::unique_ptr<Device>> make_opencl_device(const DeviceScene& scene, const DeviceOptions& options) {
  return OpenClDevice::make(scene, options);
}

}  // namespace penumbra
