#include "device/emulation/fiber.h"

#include <cstdint>

#include "core/sanitizers.h"

#if defined(__x86_64__)
#define ALIGNGS_FIBER_ASSEMBLY 1
#else
#include <ucontext.h>
#endif
#ifdef ALIGNGS_ADDRESS_SANITIZER
#include <sanitizer/asan_interface.h>
#include <sanitizer/common_interface_defs.h>
#endif

namespace aligngs::cuda {
namespace {
constexpr size_t kStackBytes = 64 * 1024;  ///< device code keeps arrays of a few KB; exceptions unwind in 10 KB
}

struct Fiber::Implementation {
  std::unique_ptr<char[]> stack;
#ifdef ALIGNGS_FIBER_ASSEMBLY
  void* stack_pointer = nullptr;
#else
  ucontext_t context{};
#endif
  const void* bottom = nullptr;  ///< of the stack, for the sanitizer
  size_t bytes = 0;
};

void Fiber::Delete::operator()(Implementation* p) const { delete p; }

Fiber::Implementation& Fiber::implementation() {
  if (!implementation_) implementation_.reset(new Implementation);
  return *implementation_;
}

#ifdef ALIGNGS_FIBER_ASSEMBLY
// Saves what a called function must preserve (System V x86-64), exchanges the stacks, restores. swapcontext would do
// the same with two system calls each time, at a hundred times the cost.
extern "C" void aligngs_switch_stack(void** from, void* to);
asm(R"(
.text
.globl aligngs_switch_stack
.type aligngs_switch_stack, @function
aligngs_switch_stack:
  pushq %rbp
  pushq %rbx
  pushq %r12
  pushq %r13
  pushq %r14
  pushq %r15
  movq %rsp, (%rdi)
  movq %rsi, %rsp
  popq %r15
  popq %r14
  popq %r13
  popq %r12
  popq %rbx
  popq %rbp
  ret
.size aligngs_switch_stack, .-aligngs_switch_stack
)");
#endif

void Fiber::prepare(void (*entry)()) {
  Implementation& f = implementation();
  if (!f.stack) f.stack.reset(new char[kStackBytes]);
  f.bottom = f.stack.get();
  f.bytes = kStackBytes;
#ifdef ALIGNGS_ADDRESS_SANITIZER
  // Frames of the thread before, which were left without returning, are gone.
  __asan_unpoison_memory_region(f.stack.get(), kStackBytes);
#endif
#ifdef ALIGNGS_FIBER_ASSEMBLY
  // From the top: the return address of entry() (none), the address that `ret` jumps to, six saved registers. On
  // arrival the stack pointer is 8 below a multiple of 16, as after a call.
  auto top = (reinterpret_cast<uintptr_t>(f.stack.get()) + kStackBytes) & ~uintptr_t(15);
  void** words = reinterpret_cast<void**>(top);
  *--words = nullptr;
  *--words = reinterpret_cast<void*>(entry);
  for (int i = 0; i < 6; ++i) *--words = nullptr;
  f.stack_pointer = words;
#else
  getcontext(&f.context);
  f.context.uc_stack.ss_sp = f.stack.get();
  f.context.uc_stack.ss_size = kStackBytes;
  f.context.uc_link = nullptr;
  makecontext(&f.context, entry, 0);
#endif
}

#ifdef ALIGNGS_ADDRESS_SANITIZER
namespace {
/// The stack address of the fiber that was left is known only on arrival in the next one.
struct LeftStack {
  const void** bottom = nullptr;
  size_t* bytes = nullptr;
};
thread_local LeftStack left_stack;

void finish_switch(void* fake_stack) {
  __sanitizer_finish_switch_fiber(fake_stack, left_stack.bottom, left_stack.bytes);
}
}  // namespace
#endif

void Fiber::switch_between(Fiber& from, Fiber& to, bool last) {
  Implementation& a = from.implementation();
  Implementation& b = to.implementation();
#ifdef ALIGNGS_ADDRESS_SANITIZER
  void* fake_stack = nullptr;
  left_stack = {&a.bottom, &a.bytes};
  __sanitizer_start_switch_fiber(last ? nullptr : &fake_stack, b.bottom, b.bytes);
#endif
#ifdef ALIGNGS_FIBER_ASSEMBLY
  aligngs_switch_stack(&a.stack_pointer, b.stack_pointer);
#else
  swapcontext(&a.context, &b.context);
#endif
#ifdef ALIGNGS_ADDRESS_SANITIZER
  finish_switch(fake_stack);
#endif
}

void Fiber::entered() {
#ifdef ALIGNGS_ADDRESS_SANITIZER
  finish_switch(nullptr);
#endif
}

}  // namespace aligngs::cuda
