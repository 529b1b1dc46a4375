// The emulated twin of stream capture: while a tape records, operations put on the stream are kept and not carried out.
// It keeps their order and their arguments.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace aligngs::cuda {

class EmulatedTape {
 public:
  void add(const char* name, std::function<void()> operation) { operations_.push_back({name, std::move(operation)}); }
  void play() const {
    for (const Operation& o : operations_) o.run();
  }
  size_t size() const { return operations_.size(); }
  /// The same operations in the same order, whatever their arguments: what makes one graph an update of another.
  bool like(const EmulatedTape& other) const;

 private:
  struct Operation {
    std::string name;
    std::function<void()> run;
  };
  std::vector<Operation> operations_;
};

/// The tape that records what the calling thread puts on a stream; nullptr: operations are carried out at once.
EmulatedTape* recording_tape();

/// Lets a tape record while it lives. They do not nest.
class ScopedRecording {
 public:
  explicit ScopedRecording(EmulatedTape& tape);
  ~ScopedRecording();
  ScopedRecording(const ScopedRecording&) = delete;
  ScopedRecording& operator=(const ScopedRecording&) = delete;
};

/// Carries an operation of the stream out, or records a copy of it.
template <class Operation>
void emulated_stream_operation(const char* name, const Operation& operation) {
  if (EmulatedTape* tape = recording_tape()) {
    tape->add(name, operation);
  } else {
    operation();
  }
}

/// Throws Error{kFailed} while a tape records. An operation that waits for the device cannot be captured, nor one that
/// reads host memory which may be gone when the graph runs.
void refuse_while_recording(const char* what);

}  // namespace aligngs::cuda
