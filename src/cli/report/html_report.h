// report.html of a run: numbers, pictures, charts and settings in one file that opens offline.
#pragma once

#include <filesystem>
#include <string>

namespace aligngs {

/// Builds the page from files of the run folder: run.json, metrics.json, events.ndjson, config.toml and renders/test. A
/// missing file is named in the page, not an error. Error{kBadInput} for a run.json or metrics.json that is damaged.
std::string html_report(const std::filesystem::path& run);

/// Writes report.html and overview.jpg (photo, render, depth, normals, labels of a few test views side by side; not
/// written without renders). Atomic.
void write_report(const std::filesystem::path& run);

}  // namespace aligngs
