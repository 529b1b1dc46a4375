// Adds up what a stage will need before it starts, and refuses with the sum shown when it does not fit.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace aligngs {

class MemoryBudget {
 public:
  /// limit_bytes == 0: 80 % of the memory available now (MemAvailable, and the cgroup's limit).
  explicit MemoryBudget(uint64_t limit_bytes = 0);

  void add(std::string what, uint64_t bytes);
  uint64_t total() const;
  uint64_t limit() const { return limit_; }
  /// One line per item and the sum.
  std::string table() const;
  /// Throws Error{kResources} with the table and the given remedy when the sum exceeds the limit.
  void require(const std::string& stage, const std::string& remedy) const;

 private:
  uint64_t limit_;
  std::vector<std::pair<std::string, uint64_t>> items_;
};

uint64_t available_memory_bytes();  ///< free for use now
uint64_t peak_memory_bytes();       ///< of this process so far (high-water mark of resident memory)

}  // namespace aligngs
