#include "op_table.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "device/tolerances.h"
#include "io/npy.h"

namespace aligngs::op_compare {
namespace {

const char* name_of(LimitKind kind) {
  switch (kind) {
    case LimitKind::kExact:
      return "exact";
    case LimitKind::kTight:
      return "tight";
    case LimitKind::kLoose:
      return "loose";
  }
  return "";
}

double largest(const std::vector<double>& values) {
  double most = 0;
  for (const double v : values) {
    if (std::isfinite(v)) most = std::max(most, std::abs(v));
  }
  return most;
}

/// |a - b|; what is not finite is equal to itself alone.
double distance(double a, double b) {
  if (a == b || (std::isnan(a) && std::isnan(b))) return 0;
  const double d = std::abs(a - b);
  return std::isfinite(d) ? d : std::numeric_limits<double>::infinity();
}

}  // namespace

Limit exact(double flips) { return {LimitKind::kExact, 0, true, flips}; }
Limit tight(double value) { return {LimitKind::kTight, value, false, cuda::CudaTolerance().flips}; }
Limit loose(double value) { return {LimitKind::kLoose, value, false, cuda::CudaTolerance().flips}; }
Limit with_large_flips(Limit limit) {
  limit.flips = cuda::CudaTolerance().large_flips;
  return limit;
}
Limit with_two_view_flips(Limit limit) {
  limit.flips = cuda::CudaTolerance().two_view_flips;
  return limit;
}
Limit absolute(Limit limit) {
  limit.absolute = true;
  limit.flips = 0;
  return limit;
}

void OpTable::add(const std::string& op, const std::string& channel, const std::vector<double>& got,
                  const std::vector<double>& want, const Limit& limit) {
  OpRow row;
  row.op = op;
  row.channel = channel;
  row.limit = limit;
  row.entries = want.size();
  if (got.size() != want.size()) {
    row.beyond = std::max(got.size(), want.size());
    row.worst = row.rms = std::numeric_limits<double>::infinity();
  } else {
    const double top = largest(want), unit = limit.absolute || top == 0 ? 1 : top;
    double squares = 0;
    for (size_t i = 0; i < got.size(); ++i) {
      const double d = distance(got[i], want[i]) / unit;
      row.worst = std::max(row.worst, d);
      squares += d * d;
      row.beyond += d > limit.value;
    }
    if (!got.empty()) row.rms = std::sqrt(squares / static_cast<double>(got.size()));
    // A number on one side alone is no flip, however many entries there are.
    row.ok = std::isfinite(row.worst) &&
             static_cast<double>(row.beyond) <= std::floor(limit.flips * static_cast<double>(got.size()));
  }
  rows_.push_back(row);
  if (dump_.empty()) return;
  dump(op + "." + channel + ".cpu", want);
  dump(op + "." + channel + ".device", got);
}

void OpTable::dump(const std::string& name, const std::vector<double>& values) const {
  std::filesystem::create_directories(dump_);
  std::string file = name;
  std::replace(file.begin(), file.end(), ' ', '_');
  const std::vector<float> numbers(values.begin(), values.end());
  write_npy_float32(dump_ / (file + ".npy"), {static_cast<int64_t>(numbers.size())}, numbers.data());
}

bool OpTable::ok() const {
  return std::all_of(rows_.begin(), rows_.end(), [](const OpRow& row) { return row.ok; });
}

std::string OpTable::text() const {
  std::string out;
  char line[200];
  const auto put = [&](const char* format, auto... values) {
    std::snprintf(line, sizeof line, format, values...);
    out += line;
  };
  put("%-20s %-24s %10s %10s %10s %8s %-6s %10s\n", "op", "channel", "entries", "worst", "RMS", "beyond", "kind",
      "limit");
  for (const OpRow& r : rows_) {
    put("%-20s %-24s %10zu %10.2e %10.2e %8zu %-6s %10.2e  %s\n", r.op.c_str(), r.channel.c_str(), r.entries, r.worst,
        r.rms, r.beyond, name_of(r.limit.kind), r.limit.value, r.ok ? "ok" : "FAIL");
  }
  const auto failed = std::count_if(rows_.begin(), rows_.end(), [](const OpRow& row) { return !row.ok; });
  put("%zu channels, %zu beyond their limit\n", rows_.size(), static_cast<size_t>(failed));
  return out;
}

}  // namespace aligngs::op_compare
