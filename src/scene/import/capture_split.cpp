#include "scene/import/capture_split.h"

#include <fmt/format.h>
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
#include "scene/scene.h"

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
  std::set<int> taken;
  std::string unknown;
  for (const std::string& name : names) {
    const int found = frames.find(name);
    if (found >= 0 && !taken.insert(found).second) continue;  // a name that is there twice counts once
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

std::vector<int> without(std::vector<int> frames, const std::vector<int>& taken) {
  std::erase_if(frames, [&](int i) { return std::find(taken.begin(), taken.end(), i) != taken.end(); });
  return frames;
}

std::vector<int> all_frames(const Capture& capture) {
  std::vector<int> frames(capture.frames.size());
  std::iota(frames.begin(), frames.end(), 0);
  return frames;
}

/// Training views by coverage, none of them in `reserved`.
std::vector<int> chosen_views(const Capture& capture, int count, const std::vector<int>& reserved, ThreadPool& pool) {
  ViewSelectionOptions options;
  options.count = count;
  if (reserved.empty()) return select_views(capture, options, pool);
  const std::vector<int> free = without(all_frames(capture), reserved);
  Capture others = capture;
  others.frames.clear();
  for (const int i : free) others.frames.push_back(capture.frames[static_cast<size_t>(i)]);
  std::vector<int> chosen = select_views(others, options, pool);
  for (int& i : chosen) i = free[static_cast<size_t>(i)];
  return chosen;
}

/// `count` of a list, spread evenly over it.
std::vector<int> thinned(const std::vector<int>& frames, int count) {
  const size_t wanted = std::min(frames.size(), static_cast<size_t>(count));
  std::vector<int> kept;
  for (size_t k = 0; k < wanted; ++k) kept.push_back(frames[(2 * k + 1) * frames.size() / (2 * wanted)]);
  return kept;
}

/// Frames that are asked for by number, where all frames would train.
std::vector<int> held_out(const Capture& capture, int count, ThreadPool& pool) {
  const int most = static_cast<int>(capture.frames.size()) - static_cast<int>(kFewestTrainingViews);
  if (count > most)
    throw_usage(fmt::format("--test-views {} leaves fewer than {} of {} frames for training", count,
                            kFewestTrainingViews, capture.frames.size()),
                fmt::format("use --test-views {} or fewer", std::max(0, most)));
  return select_test_views(capture, {}, count, pool);
}

/// The option or list that decides which frames train, and how more of them would.
struct CauseOfTraining {
  std::string option, remedy;
};

CauseOfTraining cause_of_training(const Capture& capture, const ImportOptions& options, const std::vector<int>& test) {
  const bool names_test = !options.test_names.empty();
  if (options.views == 1) return {"--views 1", fmt::format("use --views {} or more", kFewestTrainingViews)};
  if (options.stride > 0) {
    const int all = static_cast<int>(capture.frames.size());
    for (int stride = std::min(options.stride, all) - 1; stride > 0; --stride) {
      if (without(select_stride(capture, stride), test).size() >= kFewestTrainingViews)
        return {fmt::format("--stride {}", options.stride), fmt::format("use --stride {} or less", stride)};
    }
  }
  if (!options.train_names.empty()) return {"--train", fmt::format("name {} frames or more", kFewestTrainingViews)};
  if (names_test) return {"--test", "name fewer frames"};
  const bool own_train = options.views == 0 && options.stride == 0 && !capture.train.empty();
  return {own_train ? "the training list of the capture" : "the test list of the capture",
          "correct the list, or name frames with --train of `aligngs import`"};
}

/// Error{kBadInput} where options or lists leave too few of more frames. A single frame trains alone.
void require_enough_to_train(const Capture& capture, const ImportOptions& options, const CaptureSplit& split) {
  const size_t kept = split.train.size(), all = capture.frames.size();
  if (kept >= kFewestTrainingViews || (kept == 1 && all == 1)) return;
  const bool names_lost_frames = options.train_names.empty() && capture.train.size() >= kFewestTrainingViews;
  if (names_lost_frames && options.views == 0 && options.stride == 0)
    require_enough(capture.folder, all, capture.left_out, all + 1, false);
  const CauseOfTraining cause = cause_of_training(capture, options, split.test);
  throw_bad_input(
      capture.folder, cause.option,
      fmt::format("this leaves {} of {} frames for training, and {} are needed", kept, all, kFewestTrainingViews),
      cause.remedy);
}

/// The frames that are named for both. They train.
void keep_apart(const Capture& capture, CaptureSplit& split) {
  std::vector<std::string> both;
  std::erase_if(split.test, [&](int i) {
    const bool trains = std::find(split.train.begin(), split.train.end(), i) != split.train.end();
    if (trains) both.push_back(capture.frames[static_cast<size_t>(i)].name);
    return trains;
  });
  if (!both.empty()) log_warning("{} frames are in both lists and train: {}", both.size(), fmt::join(both, ", "));
}

}  // namespace

CaptureSplit split_capture(const Capture& capture, const ImportOptions& options, ThreadPool& pool) {
  const int given = (options.views > 0) + (options.stride > 0) + !options.train_names.empty();
  if (given > 1) throw_usage("give only one of --views, --stride and --train");
  const bool names_test = !options.test_names.empty(), counts_test = options.test_views >= 0;
  if (names_test && counts_test) throw_usage("give only one of --test and --test-views");
  CaptureSplit split;
  if (names_test) split.test = indices_of(capture, options.test_names, "--test", false);
  const bool own_train = given == 0 && !capture.train.empty();
  const bool own_test = given == 0 && !names_test && !capture.test.empty();
  if (own_test) split.test = indices_of(capture, capture.test, "the test list of the capture", true);
  const bool many = capture.frames.size() > kMaxUnselected;
  if (!names_test && !own_test && given == 0 && !own_train && !many && options.test_views > 0)
    split.test = held_out(capture, options.test_views, pool);

  if (options.views > 0) {
    split.train = chosen_views(capture, options.views, split.test, pool);
  } else if (options.stride > 0) {
    split.train = without(select_stride(capture, options.stride), split.test);
  } else if (!options.train_names.empty()) {
    split.train = indices_of(capture, options.train_names, "--train", false);
  } else if (own_train) {
    split.train = indices_of(capture, capture.train, "the training list of the capture", true);
    if (names_test) split.train = without(split.train, split.test);
  } else if (many) {
    log_info("choosing {} of {} frames (--views, --stride or --train change that)", kDefaultViews,
             capture.frames.size());
    split.train = chosen_views(capture, kDefaultViews, split.test, pool);
  } else {
    split.train = without(all_frames(capture), split.test);
  }
  require_enough_to_train(capture, options, split);

  if (own_test && counts_test) split.test = thinned(split.test, options.test_views);
  if (!names_test && !own_test && split.test.empty()) {
    const int wanted = counts_test ? options.test_views : static_cast<int>(split.train.size()) / 3;
    split.test = select_test_views(capture, split.train, wanted, pool);
  }
  keep_apart(capture, split);
  const int found = static_cast<int>(split.test.size());
  if (found < options.test_views) log_warning("{} of {} test views: no other frame is left", found, options.test_views);
  return split;
}

}  // namespace aligngs
