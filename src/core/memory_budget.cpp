#include "core/memory_budget.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <fstream>
#include <limits>

#include "core/error.h"
#include "core/progress.h"

namespace aligngs {
namespace {

constexpr double kShareOfAvailable = 0.8;  // leaves room for the page cache and for other programs

uint64_t mem_available() {
  std::ifstream file("/proc/meminfo");
  std::string key, unit;
  uint64_t kilobytes = 0;
  while (file >> key >> kilobytes >> unit) {
    if (key == "MemAvailable:") return kilobytes * 1024;
  }
  return std::numeric_limits<uint64_t>::max();
}

uint64_t cgroup_left() {
  std::ifstream limit_file("/sys/fs/cgroup/memory.max"), used_file("/sys/fs/cgroup/memory.current");
  uint64_t limit = 0, used = 0;
  if (!(limit_file >> limit) || !(used_file >> used)) return std::numeric_limits<uint64_t>::max();
  return limit > used ? limit - used : 0;
}

}  // namespace

uint64_t available_memory_bytes() { return std::min(mem_available(), cgroup_left()); }

uint64_t peak_memory_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<uint64_t>(usage.ru_maxrss) * 1024;
}

MemoryBudget::MemoryBudget(uint64_t limit_bytes)
    : limit_(limit_bytes ? limit_bytes
                         : static_cast<uint64_t>(kShareOfAvailable * static_cast<double>(available_memory_bytes()))) {}

void MemoryBudget::add(std::string what, uint64_t bytes) { items_.emplace_back(std::move(what), bytes); }

uint64_t MemoryBudget::total() const {
  uint64_t sum = 0;
  for (const auto& item : items_) sum += item.second;
  return sum;
}

std::string MemoryBudget::table() const {
  std::string text;
  for (const auto& [what, bytes] : items_) text += fmt::format("    {:<40} {:>10}\n", what, format_bytes(bytes));
  return text + fmt::format("    {:<40} {:>10}", "sum", format_bytes(total()));
}

void MemoryBudget::require(const std::string& stage, const std::string& remedy) const {
  if (total() <= limit_) return;
  throw_resources({},
                  fmt::format("{} needs {}, but the budget is {}:\n{}", stage, format_bytes(total()),
                              format_bytes(limit_), table()),
                  remedy);
}

}  // namespace aligngs
