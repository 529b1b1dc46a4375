// The CUDA execution model on the CPU, for tests. Blocks run one at a time; each of their threads is a fiber on the
// calling host thread. A barrier or warp operation yields to the next thread. Nothing depends on time, so a run can be
// repeated exactly. The order in which threads take turns can be changed to find missing barriers.
//
// Mistakes that hang or corrupt on a device are errors here (Error{kFailed} naming block and thread). Examples are a
// barrier that some threads never reach, a warp operation with a missing lane, lanes of one warp in different
// operations.
#pragma once

#include <cstddef>
#include <cstdint>

namespace aligngs::cuda {

/// In which order the threads of a block (and the blocks of a grid) run between barriers.
enum class ThreadOrder { kForward, kReverse, kShuffled };

/// Sets the order for the calling thread of the host while it lives.
class ScopedThreadOrder {
 public:
  explicit ScopedThreadOrder(ThreadOrder order, uint64_t seed = 1);
  ~ScopedThreadOrder();
  ScopedThreadOrder(const ScopedThreadOrder&) = delete;
  ScopedThreadOrder& operator=(const ScopedThreadOrder&) = delete;

 private:
  ThreadOrder previous_order_;
  uint64_t previous_seed_;
};

struct EmulatedIndex {
  unsigned x = 0, y = 0, z = 0;
};
struct EmulatedShape {
  constexpr EmulatedShape(unsigned x_ = 1, unsigned y_ = 1, unsigned z_ = 1) : x(x_), y(y_), z(z_) {}
  unsigned x, y, z;
  constexpr size_t count() const { return size_t(x) * y * z; }
};

/// Runs body(context) once per thread of every block. Shared memory starts filled with 0xFF (NaN).
/// Throws what a thread throws, and Error{kFailed} on the mistakes named above.
void emulate_grid(EmulatedShape grid, EmulatedShape block, size_t shared_bytes, void (*body)(void*), void* context);

/// Indices of the running thread.
extern constinit thread_local EmulatedIndex emulated_thread, emulated_block;
extern constinit thread_local EmulatedShape emulated_block_shape, emulated_grid_shape;

constexpr int kEmulatedWarp = 32;

/// All threads of the block meet. Returns how many came with `predicate`.
int emulated_barrier(bool predicate);
/// The lanes in `mask` meet with one payload each. When the last arrives, `complete` runs once over the payloads (null
/// for lanes outside the mask) and all continue. `kind` tells operations apart.
void emulated_collective(uint32_t mask, int kind, void* payload, void (*complete)(void* const* payloads));
/// Index of the running thread in its warp.
int emulated_lane();
/// Dynamic shared memory of the running block, aligned to 128 bytes.
void* emulated_shared_memory();

/// Launches so far on this thread of the host, for tests of what a step launches.
uint64_t emulated_launches();

}  // namespace aligngs::cuda
