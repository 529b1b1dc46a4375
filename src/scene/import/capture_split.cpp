#include "scene/import/capture_split.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <numeric>
#include <set>
#include <string>

#include "core/error.h"
#include "core/letter_case.h"
#include "core/log.h"
#include "io/text_encoding.h"
#include "scene/import/capture_frames.h"
#include "scene/import/view_selection.h"

namespace aligngs {

namespace {

/// The first line of a list that a spreadsheet has written.
bool is_header(const std::string& name) {
  static const std::set<std::string> kWords = {"name",      "names", "file",   "files",      "filename",
                                               "file_name", "image", "images", "image_name", "photo",
                                               "photos",    "frame", "frames", "view"};
  return kWords.count(lower_case(name)) > 0;
}

std::vector<int> indices_of(const Capture& capture, const std::vector<std::string>& names, const char* list,
                            bool skip_lost) {
  const FrameNames frames(capture.frames);
  std::set<std::string> lost;
  for (const LeftOut& frame : capture.left_out) lost.insert({frame.name, view_name_of(frame.name)});
  std::vector<int> indices;
  std::string unknown;
  for (const std::string& name : names) {
    const int found = frames.find(name);
    if (found >= 0)
      indices.push_back(found);
    else if (!lost.count(as_utf8(name)) && !lost.count(view_name_of(name)) &&
             !(&name == &names.front() && names.size() > 1 && is_header(name)))
      unknown += (unknown.empty() ? " " : ", ") + as_utf8(name);
  }
  if (!unknown.empty() && !skip_lost)
    throw_bad_input(capture.folder, list, "no frame with a pose is called" + unknown,
                    "use the names of the image files, one a line");
  if (!unknown.empty()) log_warning("{}: these frames have no pose and are left out:{}", list, unknown);
  return indices;
}

}  // namespace

CaptureSplit split_capture(const Capture& capture, const ImportOptions& options, ThreadPool& pool) {
  const int given = (options.views > 0) + (options.stride > 0) + !options.train_names.empty();
  if (given > 1) throw_usage("give only one of --views, --stride and --train");
  CaptureSplit selection;
  const bool own_split = given == 0 && !capture.train.empty();
  if (options.views > 0) {
    ViewSelectionOptions view_options;
    view_options.count = options.views;
    selection.train = select_views(capture, view_options, pool);
  } else if (options.stride > 0) {
    selection.train = select_stride(capture, options.stride);
  } else if (!options.train_names.empty()) {
    selection.train = indices_of(capture, options.train_names, "--train", false);
  } else if (own_split) {
    selection.train = indices_of(capture, capture.train, "the training list of the capture", true);
  } else if (capture.frames.size() > kMaxUnselected) {
    log_info("choosing {} of {} frames (--views, --stride or --train change that)", kDefaultViews,
             capture.frames.size());
    ViewSelectionOptions view_options;
    view_options.count = kDefaultViews;
    selection.train = select_views(capture, view_options, pool);
  } else {
    selection.train.resize(capture.frames.size());
    std::iota(selection.train.begin(), selection.train.end(), 0);
    if (!capture.test.empty()) {  // only test names came with the capture: the others train
      const std::vector<int> test = indices_of(capture, capture.test, "the test list of the capture", true);
      std::erase_if(selection.train, [&](int i) { return std::find(test.begin(), test.end(), i) != test.end(); });
    }
  }
  if (!options.test_names.empty()) {
    selection.test = indices_of(capture, options.test_names, "--test", false);
  } else if (given == 0 && !capture.test.empty()) {
    selection.test = indices_of(capture, capture.test, "the test list of the capture", true);
  } else {
    const int wanted = options.test_views >= 0 ? options.test_views : static_cast<int>(selection.train.size()) / 3;
    selection.test = select_test_views(capture, selection.train, wanted, pool);
  }
  std::vector<std::string> both;
  std::erase_if(selection.test, [&](int i) {
    const bool trains = std::find(selection.train.begin(), selection.train.end(), i) != selection.train.end();
    if (trains) both.push_back(capture.frames[static_cast<size_t>(i)].name);
    return trains;
  });
  if (!both.empty()) log_warning("{} frames are in both lists and train: {}", both.size(), fmt::join(both, ", "));
  if (selection.train.empty()) throw_bad_input(capture.folder, "train", "no training view is left", "give other names");
  return selection;
}

}  // namespace aligngs
