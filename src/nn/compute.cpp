#include "nn/compute.h"

#include <cstdlib>
#include <new>

#include "nn/cpu/amx_attention.h"
#include "nn/cpu/matrix_backend.h"
#include "nn/network_device.h"

namespace aligngs::nn {

namespace {

/// Weights on a device.
class DeviceMatrices : public MatrixBackend {
 public:
  DeviceMatrices(std::shared_ptr<NetworkDevice> device, Precision precision)
      : device_(std::move(device)), precision_(precision) {}
  std::string name() const override { return device_->name(); }
  std::unique_ptr<PackedMatrix> pack(const float* weights, int64_t outputs, int64_t inputs) const override {
    return device_->pack(weights, outputs, inputs, precision_);
  }

 private:
  std::shared_ptr<NetworkDevice> device_;
  Precision precision_;
};

std::shared_ptr<MatrixBackend> matrices_of(const ComputeOptions& options) {
  if (options.device) return std::make_shared<DeviceMatrices>(options.device, options.precision);
  return make_matrix_backend(options);
}

}  // namespace

AlignedBytes::AlignedBytes(size_t bytes) : size_(bytes) {
  constexpr size_t kAlignment = 64;  // a cache line, and a vector of AVX-512
  const size_t rounded = (bytes + kAlignment - 1) / kAlignment * kAlignment;
  memory_.reset(static_cast<char*>(std::aligned_alloc(kAlignment, rounded > 0 ? rounded : kAlignment)));
  if (!memory_) throw std::bad_alloc();
}

void AlignedBytes::Free::operator()(char* memory) const { std::free(memory); }

void* Scratch::bytes(size_t count) {
  if (used_ == buffers_.size()) buffers_.emplace_back();
  AlignedBytes& buffer = buffers_[used_++];
  if (buffer.size() < count) buffer = AlignedBytes(count);
  return buffer.get();
}

Compute::Compute(ThreadPool& pool, const ComputeOptions& options)
    : pool_(pool),
      options_(options),
      amx_(!options.device && options.precision == Precision::kBfloat16 && options.amx && amx_attention_usable()),
      matrices_(matrices_of(options)),
      exact_matrices_(matrices_),
      scratch_(static_cast<size_t>(pool.size())) {
  if (options.precision == Precision::kFloat32) return;
  ComputeOptions exact = options;
  exact.precision = Precision::kFloat32;
  exact_matrices_ = matrices_of(exact);
}

Compute::~Compute() = default;

void Compute::for_rows(int64_t rows, int64_t chunk, const std::function<void(int64_t, int64_t, Scratch&)>& body) {
  // A chunk streams all weights through the cache once: long chunks use them more often, short ones
  // share few rows among the threads evenly.
  constexpr int64_t kManyRows = 4096, kLong = 256, kShort = 128;
  if (chunk <= 0) chunk = rows >= kManyRows ? kLong : kShort;
  pool_.parallel_for(static_cast<size_t>(rows), static_cast<size_t>(chunk), [&](size_t begin, size_t end, int worker) {
    Scratch& own = scratch(worker);
    const Scratch::Frame frame(own);
    body(static_cast<int64_t>(begin), static_cast<int64_t>(end - begin), own);
  });
}

}  // namespace aligngs::nn
