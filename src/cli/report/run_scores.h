// The figures of a finished run, as rows that can be put under each other.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "metrics/run_metrics.h"

namespace aligngs {

/// Columns of a comparison, in the order in which they are printed. "between" and "beyond" are the PSNR (dB) of test
/// views that interpolate and extrapolate the training views (metrics/view_novelty.h).
enum class Score {
  kPsnr,
  kPsnrFitted,
  kPsnrPose,
  kPsnrBetween,
  kPsnrBeyond,
  kSsim,
  kLpips,
  kAccuracy,
  kCompleteness,
  kPrecision,
  kRecall,
  kFscore,
  kFscore2,
  kFscore1,
  kNormals,
  kStructureNormals,
  kRoughness,
  kPinholes,
  kMiou,
  kMiouPresent,
  kSeconds,
  kGaussians
};
inline constexpr size_t kScoreCount = 22;

struct ScoreColumn {
  const char* name;      ///< heading, with unit
  const char* csv_name;  ///< column of the CSV
  double (*value)(const RunMetrics&);
  int digits;  ///< after the decimal point
};
const std::array<ScoreColumn, kScoreCount>& score_columns();

/// Figures that every test view has of its own: only these have intervals when two runs are compared.
struct ViewScoreColumn {
  const char* name;      ///< with unit
  const char* csv_name;  ///< begin of the member of JSON that has its difference
  double TestViewMetrics::*score;
  int digits;
};
const std::array<ViewScoreColumn, 3>& view_score_columns();

struct RunScores {
  std::string name;  ///< last part of the folder's path
  std::filesystem::path folder;
  std::array<double, kScoreCount> score{};  ///< NaN where the run has no such figure
  std::vector<TestViewMetrics> views;
  std::string protocol;     ///< of the geometry figures
  std::string priors;       ///< "simulated ..." where they are
  bool other_room = false;  ///< its photos are not those of the first run (same_room.h): no view has a pair

  double operator[](Score s) const { return score[static_cast<size_t>(s)]; }
};

/// Error{kBadInput} for a folder that is no run, without metrics.json, or with one that is no JSON object.
RunScores read_run_scores(const std::filesystem::path& run);

/// The figure in its column's digits, "–" for NaN.
std::string score_text(size_t column, double value);

}  // namespace aligngs
