// Runs side by side: a table, CSV, paired differences over the views that all share, and a page with pictures.
#pragma once

#include <string>
#include <vector>

#include "cli/report/run_scores.h"
#include "metrics/paired_difference.h"

namespace aligngs {

/// Makes names unique: runs whose folders are called the same keep the path as typed.
void name_apart(std::vector<RunScores>& runs);

/// A header line and a line per run, full precision, empty where there is no figure.
std::string comparison_csv(const std::vector<RunScores>& runs);

/// Aligned text for a terminal, then each run's differences from the first over the test views both have.
std::string comparison_text(const std::vector<RunScores>& runs);

/// Difference in one figure of `run` from `base`, view by view.
PairedDifference view_difference(const RunScores& base, const RunScores& run,
                                 double TestViewMetrics::*score = &TestViewMetrics::psnr);

/// Reasons why the figures are hard to compare: other test views, another protocol, simulated priors beside real ones.
std::vector<std::string> comparison_warnings(const std::vector<RunScores>& runs);

/// One page that opens offline: the table and, for each test view, the photo beside every run's render, depth, normals
/// and labels. Views without a render are left out.
std::string comparison_page(const std::vector<RunScores>& runs);

}  // namespace aligngs
