// Threads of execution that take turns on one thread of the host: what the CUDA emulation runs device threads on.
#pragma once

#include <cstddef>
#include <memory>

namespace aligngs::cuda {

/// A stack and a place in the code. The one that represents the caller needs no stack of its own.
class Fiber {
 public:
  Fiber() = default;
  Fiber(Fiber&&) = default;
  Fiber& operator=(Fiber&&) = default;

  /// The next switch to this fiber calls entry(), which must never return: it ends by switching away for good.
  void prepare(void (*entry)());

  /// Goes on in `to` and returns when something switches back to `from`. `last`: `from` is never resumed.
  static void switch_between(Fiber& from, Fiber& to, bool last = false);
  /// First call in a fiber's entry (address sanitizer wants to know).
  static void entered();

 private:
  struct Implementation;
  struct Delete {
    void operator()(Implementation* p) const;
  };
  Implementation& implementation();
  std::unique_ptr<Implementation, Delete> implementation_;
};

}  // namespace aligngs::cuda
