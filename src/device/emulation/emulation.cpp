#include "device/emulation/emulation.h"

#include <algorithm>
#include <cstring>
#include <exception>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include "core/error.h"
#include "device/emulation/fiber.h"

namespace aligngs::cuda {

constinit thread_local EmulatedIndex emulated_thread{}, emulated_block{};
constinit thread_local EmulatedShape emulated_block_shape{}, emulated_grid_shape{};

namespace {

constexpr size_t kMaxThreads = 1024;            ///< per block, as on every device
constexpr size_t kMaxSharedBytes = 227 * 1024;  ///< what a block may ask for on sm_90, the largest of our targets

enum class ThreadState : uint8_t { kReady, kAtBarrier, kAtCollective, kDone };

struct EmulatedThread {
  Fiber fiber;
  ThreadState state = ThreadState::kReady;
  EmulatedIndex index;
};

/// Lanes of a warp on their way into one operation.
struct Meeting {
  uint32_t mask = 0, arrived = 0;
  int kind = 0;
  void* payloads[kEmulatedWarp] = {};
};
/// Groups of lanes with disjoint masks may be in operations of their own.
using WarpMeetings = std::vector<Meeting>;

thread_local ThreadOrder thread_order = ThreadOrder::kForward;
thread_local uint64_t thread_order_seed = 1;
thread_local uint64_t launches = 0;

/// Splitmix64: enough to shuffle with, and the same on every machine.
uint64_t next_random(uint64_t& state) {
  uint64_t z = (state += 0x9e3779b97f4a7c15ull);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
  return z ^ (z >> 31);
}

void arrange(std::vector<uint32_t>& order, uint64_t& random) {
  std::iota(order.begin(), order.end(), 0u);
  if (thread_order == ThreadOrder::kReverse) std::reverse(order.begin(), order.end());
  if (thread_order != ThreadOrder::kShuffled) return;
  for (size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[next_random(random) % i]);
}

class BlockEmulator {
 public:
  void run(size_t count, size_t shared_bytes, void (*body)(void*), void* context, uint64_t& random);

  int barrier(bool predicate);
  void collective(uint32_t mask, int kind, void* payload, void (*complete)(void* const*));
  int lane() const { return static_cast<int>(current_ % kEmulatedWarp); }
  void* shared_memory() {
    return reinterpret_cast<void*>((reinterpret_cast<uintptr_t>(shared_.data()) + 127) & ~uintptr_t(127));
  }
  bool running() const { return running_; }

 private:
  static void enter();
  void resume(size_t thread);
  void yield() { Fiber::switch_between(threads_[current_].fiber, scheduler_); }
  void select(size_t thread) {
    current_ = thread;
    emulated_thread = threads_[thread].index;
  }
  [[noreturn]] void fail(const std::string& what) const;
  [[noreturn]] void fail_stuck() const;

  std::vector<EmulatedThread> threads_;
  Meeting& join(WarpMeetings& meetings, uint32_t mask, int kind) const;
  std::vector<WarpMeetings> warps_;
  std::vector<unsigned char> shared_;
  Fiber scheduler_;
  size_t count_ = 0, current_ = 0, done_ = 0, at_barrier_ = 0;
  int predicates_ = 0, predicate_result_ = 0;
  void (*body_)(void*) = nullptr;
  void* context_ = nullptr;
  std::exception_ptr error_;
  bool running_ = false;
};

BlockEmulator& emulator() {
  static thread_local std::unique_ptr<BlockEmulator> instance = std::make_unique<BlockEmulator>();
  return *instance;
}

std::string text_of(const EmulatedIndex& i) {
  return "(" + std::to_string(i.x) + ", " + std::to_string(i.y) + ", " + std::to_string(i.z) + ")";
}

void BlockEmulator::fail(const std::string& what) const {
  throw Error({ErrorKind::kFailed,
               "emulated CUDA block " + text_of(emulated_block) + ", thread " + text_of(emulated_thread) + ": " + what,
               {},
               {},
               {}});
}

void BlockEmulator::fail_stuck() const {
  size_t at_collective = 0;
  for (size_t i = 0; i < count_; ++i) at_collective += threads_[i].state == ThreadState::kAtCollective;
  fail("no thread can go on: " + std::to_string(at_barrier_) + " wait at a barrier, " + std::to_string(at_collective) +
       " in a warp operation, " + std::to_string(done_) + " of " + std::to_string(count_) + " have returned");
}

void BlockEmulator::enter() {
  Fiber::entered();
  BlockEmulator& self = emulator();
  try {
    self.body_(self.context_);
  } catch (...) {
    self.error_ = std::current_exception();
  }
  self.threads_[self.current_].state = ThreadState::kDone;
  ++self.done_;
  Fiber::switch_between(self.threads_[self.current_].fiber, self.scheduler_, true);
  std::terminate();  // nobody resumes a thread that has returned
}

void BlockEmulator::resume(size_t thread) {
  select(thread);
  Fiber::switch_between(scheduler_, threads_[thread].fiber);
}

void BlockEmulator::run(size_t count, size_t shared_bytes, void (*body)(void*), void* context, uint64_t& random) {
  if (threads_.size() < count) threads_.resize(count);
  warps_.assign((count + kEmulatedWarp - 1) / kEmulatedWarp, WarpMeetings{});
  shared_.assign(shared_bytes + 128, 0xFF);
  count_ = count;
  done_ = at_barrier_ = 0;
  predicates_ = predicate_result_ = 0;
  body_ = body;
  context_ = context;
  error_ = nullptr;
  running_ = true;
  for (size_t i = 0; i < count; ++i) {
    EmulatedThread& t = threads_[i];
    t.state = ThreadState::kReady;
    t.index.x = static_cast<unsigned>(i % emulated_block_shape.x);
    t.index.y = static_cast<unsigned>(i / emulated_block_shape.x % emulated_block_shape.y);
    t.index.z = static_cast<unsigned>(i / (size_t(emulated_block_shape.x) * emulated_block_shape.y));
    t.fiber.prepare(&BlockEmulator::enter);
  }
  std::vector<uint32_t> order(count);
  while (done_ < count && !error_) {
    arrange(order, random);
    bool progress = false;
    for (const uint32_t i : order) {
      if (threads_[i].state != ThreadState::kReady) continue;
      progress = true;
      resume(i);
      if (error_) break;
    }
    if (!progress) break;
  }
  running_ = false;
  if (error_) std::rethrow_exception(error_);
  if (done_ < count) fail_stuck();
}

int BlockEmulator::barrier(bool predicate) {
  if (done_ > 0) fail("barrier after other threads of the block have returned");
  predicates_ += predicate;
  if (++at_barrier_ == count_) {
    at_barrier_ = 0;
    predicate_result_ = predicates_;
    predicates_ = 0;
    for (size_t i = 0; i < count_; ++i) threads_[i].state = ThreadState::kReady;
  } else {
    threads_[current_].state = ThreadState::kAtBarrier;
  }
  yield();  // the last to come as well, so that a changed order shows from here on
  return predicate_result_;
}

Meeting& BlockEmulator::join(WarpMeetings& meetings, uint32_t mask, int kind) const {
  for (Meeting& m : meetings) {
    if (m.mask == mask && m.kind == kind) return m;
    if ((m.mask & mask) != 0) fail("the lanes of a warp are in different warp operations");
  }
  meetings.push_back({mask, 0, kind, {}});
  return meetings.back();
}

void BlockEmulator::collective(uint32_t mask, int kind, void* payload, void (*complete)(void* const*)) {
  const size_t warp = current_ / kEmulatedWarp, first = warp * kEmulatedWarp;
  const uint32_t bit = 1u << lane();
  if ((mask & bit) == 0) fail("warp operation whose mask leaves out the calling lane");
  for (size_t i = 0; i < kEmulatedWarp; ++i) {
    if ((mask >> i & 1u) == 0) continue;
    if (first + i >= count_ || threads_[first + i].state == ThreadState::kDone) {
      fail("warp operation with lane " + std::to_string(i) + ", which does not exist or has returned");
    }
  }
  Meeting& meeting = join(warps_[warp], mask, kind);
  meeting.payloads[lane()] = payload;
  meeting.arrived |= bit;
  if (meeting.arrived != mask) {
    threads_[current_].state = ThreadState::kAtCollective;
    yield();
    return;
  }
  if (complete != nullptr) complete(meeting.payloads);
  for (size_t i = 0; i < kEmulatedWarp; ++i) {
    if ((mask >> i & 1u) != 0) threads_[first + i].state = ThreadState::kReady;
  }
  WarpMeetings& meetings = warps_[warp];
  meetings.erase(meetings.begin() + (&meeting - meetings.data()));
}

}  // namespace

ScopedThreadOrder::ScopedThreadOrder(ThreadOrder order, uint64_t seed)
    : previous_order_(thread_order), previous_seed_(thread_order_seed) {
  thread_order = order;
  thread_order_seed = seed;
}

ScopedThreadOrder::~ScopedThreadOrder() {
  thread_order = previous_order_;
  thread_order_seed = previous_seed_;
}

void emulate_grid(EmulatedShape grid, EmulatedShape block, size_t shared_bytes, void (*body)(void*), void* context) {
  BlockEmulator& e = emulator();
  if (e.running()) throw Error({ErrorKind::kFailed, "launch from device code", {}, {}, {}});
  const size_t threads = block.count(), blocks = grid.count();
  if (threads == 0 || threads > kMaxThreads || shared_bytes > kMaxSharedBytes) {
    throw Error({ErrorKind::kFailed,
                 "emulated CUDA launch of " + std::to_string(threads) + " threads per block with " +
                     std::to_string(shared_bytes) + " bytes of shared memory",
                 {},
                 {},
                 "at most 1024 threads and 232448 bytes"});
  }
  ++launches;
  emulated_block_shape = block;
  emulated_grid_shape = grid;
  uint64_t random = thread_order_seed;
  std::vector<uint32_t> order(blocks);
  arrange(order, random);
  for (const uint32_t b : order) {
    emulated_block = {b % grid.x, b / grid.x % grid.y, b / (grid.x * grid.y)};
    e.run(threads, shared_bytes, body, context, random);
  }
}

int emulated_barrier(bool predicate) { return emulator().barrier(predicate); }
void emulated_collective(uint32_t mask, int kind, void* payload, void (*complete)(void* const*)) {
  emulator().collective(mask, kind, payload, complete);
}
int emulated_lane() { return emulator().lane(); }
void* emulated_shared_memory() { return emulator().shared_memory(); }
uint64_t emulated_launches() { return launches; }

}  // namespace aligngs::cuda
