// How far the outputs of the operations of a device are from those of the CPU, channel by channel.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <type_traits>
#include <vector>

namespace aligngs::op_compare {

enum class LimitKind { kExact, kTight, kLoose };

/// The limits of a channel.
struct Limit {
  LimitKind kind = LimitKind::kExact;
  double value = 0;       ///< of |got - want|
  bool absolute = false;  ///< in the channel's unit; else relative to its largest |want|
  double flips = 0;       ///< share of the entries that may lie beyond it (CudaTolerance::flips)
};
/// Equal; of an array, but for the share of the entries that a decision by rounding may turn.
Limit exact(double flips = 0);
/// Float32 on both sides.
Limit tight(double value);
/// Products of bfloat16 operands in between.
Limit loose(double value);
/// The same where one decision changes an entry much (CudaTolerance::large_flips).
Limit with_large_flips(Limit limit);
/// The same for gradients of the multi-view terms (CudaTolerance::two_view_flips).
Limit with_two_view_flips(Limit limit);
/// The same in the channel's unit and without exceptions, for single numbers.
Limit absolute(Limit limit);

struct OpRow {
  std::string op, channel;
  Limit limit;
  size_t entries = 0, beyond = 0;  ///< numbers compared, and those beyond the limit
  double worst = 0, rms = 0;       ///< in the unit of the limit; infinite where one side alone is not a number
  bool ok = false;
};

class OpTable {
 public:
  /// `dump` is a folder that gets OP.CHANNEL.cpu.npy and OP.CHANNEL.device.npy, flat float32; empty: nothing is kept.
  explicit OpTable(std::filesystem::path dump = {}) : dump_(std::move(dump)) {}

  /// `got` and `want` are arrays of numbers in one order. Arrays of two lengths are a failure.
  template <class Got, class Want>
  void compare(const std::string& op, const std::string& channel, const Got& got, const Want& want,
               const Limit& limit) {
    add(op, channel, numbers_of(got), numbers_of(want), limit);
  }
  /// One number.
  void compare_number(const std::string& op, const std::string& channel, double got, double want, const Limit& limit) {
    add(op, channel, {got}, {want}, limit);
  }

  const std::vector<OpRow>& rows() const { return rows_; }
  bool ok() const;
  /// The table as text, one line per channel, and a last line that counts them.
  std::string text() const;

 private:
  template <class Array>
  static std::vector<double> numbers_of(const Array& array) {
    std::vector<double> out(array.size());
    for (size_t i = 0; i < out.size(); ++i) out[i] = static_cast<double>(array[i]);
    return out;
  }
  void add(const std::string& op, const std::string& channel, const std::vector<double>& got,
           const std::vector<double>& want, const Limit& limit);
  void dump(const std::string& name, const std::vector<double>& values) const;

  std::filesystem::path dump_;
  std::vector<OpRow> rows_;
};

}  // namespace aligngs::op_compare
