// Arguments of every operator: threads, precision and memory to work in.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "core/thread_pool.h"
#include "nn/precision.h"

namespace aligngs::nn {

/// Uninitialised memory on a 64-byte boundary.
class AlignedBytes {
 public:
  AlignedBytes() = default;
  explicit AlignedBytes(size_t bytes);
  char* get() { return memory_.get(); }
  const char* get() const { return memory_.get(); }
  size_t size() const { return size_; }

 private:
  struct Free {
    void operator()(char* memory) const;
  };
  std::unique_ptr<char, Free> memory_;
  size_t size_ = 0;
};

/// A stack of buffers that belongs to one worker and is reused from call to call.
class Scratch {
 public:
  /// Returns at its end the memory that was taken while it lives.
  class Frame {
   public:
    explicit Frame(Scratch& scratch) : scratch_(scratch), mark_(scratch.used_) {}
    ~Frame() { scratch_.used_ = mark_; }
    Frame(const Frame&) = delete;
    Frame& operator=(const Frame&) = delete;

   private:
    Scratch& scratch_;
    size_t mark_;
  };

  void* bytes(size_t count);
  float* floats(size_t count) { return static_cast<float*>(bytes(count * sizeof(float))); }
  uint16_t* halves(size_t count) { return static_cast<uint16_t*>(bytes(count * sizeof(uint16_t))); }

  /// Additions and multiplications of products that were done with this stack, for benchmarks.
  void count_operations(double operations) { operations_ += operations; }
  double operations() const { return operations_; }

 private:
  std::vector<AlignedBytes> buffers_;
  size_t used_ = 0;
  double operations_ = 0;
};

class MatrixBackend;  // cpu/matrix_backend.h
class NetworkDevice;  // network_device.h

/// Makes a device when there is work for it; it goes when nobody uses it any more. Empty, or null made: the processor.
using DeviceFactory = std::function<std::shared_ptr<NetworkDevice>()>;

/// The resources of this machine that may be used.
struct ComputeOptions {
  Precision precision = Precision::kFloat32;
  bool onednn = true;                               ///< for bfloat16, see fastest_precision()
  bool amx = true;                                  ///< when the processor has it
  std::shared_ptr<NetworkDevice> device = nullptr;  ///< runs the operators; none: the processor does
};

/// bfloat16 where the processor has instructions for it and oneDNN was built in, which uses them; else float16.
Precision fastest_precision();

/// Rows of a chunk when so many threads multiply `rows` rows with weights.
int64_t product_rows(int64_t rows, int64_t threads);

class Compute {
 public:
  /// `pool` must outlive this and everything made with it.
  Compute(ThreadPool& pool, const ComputeOptions& options = {});
  ~Compute();

  ThreadPool& pool() const { return pool_; }
  Precision precision() const { return options_.precision; }
  /// Whether attention runs on the matrix unit (bfloat16 only).
  bool amx() const { return amx_; }
  /// The device on which operators run, or nullptr for the processor. Tensors stay there until code of the host looks
  /// at them.
  NetworkDevice* device() const { return options_.device.get(); }
  const ComputeOptions& options() const { return options_; }
  const std::shared_ptr<MatrixBackend>& matrices() const { return matrices_; }
  /// The same in float32, for the few places that rounding would move far.
  const std::shared_ptr<MatrixBackend>& exact_matrices() const { return exact_matrices_; }
  Scratch& scratch(int worker) { return scratch_[static_cast<size_t>(worker)]; }
  /// Additions and multiplications of all matrix products and of attention so far, on the processor.
  double operations() const;

  /// Calls body(first row, number of rows, scratch) on chunks. chunk == 0: chosen for products of matrices, such that
  /// results do not depend on the number of threads.
  void for_rows(int64_t rows, int64_t chunk, const std::function<void(int64_t, int64_t, Scratch&)>& body);

 private:
  ThreadPool& pool_;
  ComputeOptions options_;
  bool amx_ = false;
  std::shared_ptr<MatrixBackend> matrices_, exact_matrices_;
  std::vector<Scratch> scratch_;
};

}  // namespace aligngs::nn
