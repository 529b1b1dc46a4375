#include "nn/compute.h"

#include <algorithm>
#include <cstdlib>
#include <new>

#include "core/error.h"
#include "core/huge_pages.h"
#include "core/matrix_tiles.h"
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
  if (options.device && options.precision == Precision::kFloat16)
    throw_usage("float16 weights are for the processor", "choose bfloat16 or float32 for a device");
  if (options.device) return std::make_shared<DeviceMatrices>(options.device, options.precision);
  return make_matrix_backend(options);
}

}  // namespace

AlignedBytes::AlignedBytes(size_t bytes) : size_(bytes) {
  constexpr size_t kAlignment = 64;  // a cache line, and a vector of AVX-512
  const size_t rounded = (bytes + kAlignment - 1) / kAlignment * kAlignment;
  memory_.reset(static_cast<char*>(std::aligned_alloc(kAlignment, rounded > 0 ? rounded : kAlignment)));
  if (!memory_) throw std::bad_alloc();
  ask_for_huge_pages(memory_.get(), rounded, HugePages::kWhenTouched);
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
      amx_(!options.device && options.precision == Precision::kBfloat16 && options.amx && matrix_tiles_available()),
      matrices_(matrices_of(options)),
      exact_matrices_(matrices_),
      scratch_(static_cast<size_t>(pool.size())) {
  if (options.precision == Precision::kFloat32) return;
  ComputeOptions exact = options;
  exact.precision = Precision::kFloat32;
  exact_matrices_ = matrices_of(exact);
}

Compute::~Compute() = default;

Precision fastest_precision() {
  // Networks were published for bfloat16. Without instructions for it float32 products are as fast, and float16 keeps
  // eight times more of a weight.
  return onednn_multiplies_bfloat16() ? Precision::kBfloat16 : Precision::kFloat16;
}

double Compute::operations() const {
  double sum = 0;
  for (const Scratch& scratch : scratch_) sum += scratch.operations();
  return sum;
}

int64_t product_rows(int64_t rows, int64_t threads) {
  // A chunk streams all weights through the cache once: long chunks use them more often. Equal ones, as many for each
  // thread, keep no thread waiting. Whole tiles of rows are fastest.
  constexpr int64_t kLongest = 288, kShortest = 96, kTileRows = 24;  // tiles of 6 and of 8 rows
  const int64_t most = std::max<int64_t>(1, rows / kShortest);
  const int64_t rounds = std::max<int64_t>(1, (rows + kLongest * threads - 1) / (kLongest * threads));
  const int64_t chunks = std::min(most, rounds * threads);
  const int64_t chunk = (rows + chunks - 1) / chunks;
  return (chunk + kTileRows - 1) / kTileRows * kTileRows;
}

void Compute::for_rows(int64_t rows, int64_t chunk, const std::function<void(int64_t, int64_t, Scratch&)>& body) {
  // oneDNN and the matrix unit may add in another order where there are fewer rows: their chunks depend on rows alone.
  constexpr int64_t kAnyThreads = 8;
  const bool any_chunks = matrices_->rows_are_independent();
  if (chunk <= 0) chunk = product_rows(rows, any_chunks ? int64_t(pool_.size()) : kAnyThreads);
  pool_.parallel_for(static_cast<size_t>(rows), static_cast<size_t>(chunk), [&](size_t begin, size_t end, int worker) {
    Scratch& own = scratch(worker);
    const Scratch::Frame frame(own);
    body(static_cast<int64_t>(begin), static_cast<int64_t>(end - begin), own);
  });
}

}  // namespace aligngs::nn
