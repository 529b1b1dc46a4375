#include "pipeline/run_source.h"

#include <fmt/format.h>

#include "core/error.h"
#include "core/shell_word.h"
#include "io/colmap.h"
#include "io/output_place.h"
#include "io/picture_format.h"
#include "priors/photo_folder.h"
#include "priors/teacher_list.h"
#include "priors/video_frames.h"
#include "scene/import/capture.h"
#include "scene/import/unknown_layout.h"
#include "train/run_folder.h"

namespace aligngs {

namespace fs = std::filesystem;

bool needs_cameras(const RunRequest& request) {
  const fs::path& source = request.source;
  const std::string from = source.string(), run = request.train.run.string();
  const bool video = fs::is_regular_file(source) && is_video_name(source);
  if (!video && fs::is_regular_file(source)) {
    throw_bad_input(source, "", "this is neither a folder nor a video",
                    std::string(is_archive(source) ? "unpack this archive, and " : "") +
                        "give a folder of photos, a video, or a scene folder");
  }
  if (!video && !fs::is_directory(source))
    throw_bad_input(source, "", "there is no such folder", "give a folder of photos, a video, or a scene folder");
  if (video) return true;
  if (request.cameras.method != PosesMethod::kGiven && may_hold_colmap_model(source)) return false;
  const bool network = request.cameras.method == PosesMethod::kAuto || is_camera_network_method(request.cameras.method);
  if (network && fs::exists(source / "transforms.json")) {
    throw_bad_input(source, "transforms.json", "this is a nerfstudio data set, whose cameras are in transforms.json",
                    fmt::format("use them: aligngs run {0} -o {1} --method given\n  or, with depth and its own split: "
                                "aligngs import {0} -o SCENE, then aligngs run SCENE -o {1}",
                                quote_word(from), quote_word(run)));
  }
  if (request.cameras.method != PosesMethod::kColmap && request.cameras.cameras.empty()) {
    refuse_posed_capture(source, fmt::format("use them: aligngs import {0} -o SCENE, then aligngs run SCENE -o {1}",
                                             quote_word(from), quote_word(run)));
  }
  if (!has_photos(source)) {
    throw_bad_input(source, "", "neither a scene (no sparse/) nor photos (no JPEG, PNG, WebP or HEIC) are here",
                    "give a folder of photos; a posed capture becomes a scene with `aligngs import`");
  }
  return true;
}

void require_source_apart(const RunRequest& request, bool begun) {
  const fs::path& run = request.train.run;
  RunFolder(run).require_apart_from(request.source);
  if (begun || !lies_within(request.source, run / "scene")) return;
  throw Error({ErrorKind::kUsage, "the source is where the run keeps a scene of its own", request.source, "source",
               "name another run folder, or train on it as it is: aligngs train " + request.source.string() + " -o " +
                   run.string()});
}

}  // namespace aligngs
