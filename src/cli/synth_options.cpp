#include "cli/synth_options.h"
#include "cli/number_checks.h"

#include <CLI/App.hpp>
#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace aligngs {

void add_synth_options(CLI::App& command, const std::shared_ptr<SynthCommandOptions>& options) {
  SynthOptions& synth = options->synth;
  command.add_option("--room", synth.room, "kind of room")
      ->check(CLI::IsMember({"bedroom", "living", "kitchen", "office"}))
      ->capture_default_str()
      ->group("Room");
  command.add_option("--views", synth.views, "number of views, test views included")
      ->check(CLI::Range(2, 10000))
      ->capture_default_str()
      ->group("Room");
  command
      .add_option("--test-views", options->test_views,
                  "number of test views among them (default: 8, or a third of few views)")
      ->check(number_from_zero())
      ->group("Room");
  command
      .add_option("--exposure", options->exposure,
                  "each photo by itself, or an automatic exposure and white balance that drift along the walk")
      ->check(CLI::IsMember({"photo", "walk"}))
      ->capture_default_str()
      ->group("Room");
  command
      .add_flag("--gloss", synth.strong_gloss,
                "polished floor, dark polished tables, screens that reflect, a mirror, and windows with a view outside")
      ->group("Room");
  command.add_option("--size", options->size, "image size WxH (default 320x240)")->group("Room");
  command.add_option("--room-seed", synth.seed, "seed of room, furniture, light, camera path and teachers")
      ->check(seed_number())
      ->capture_default_str()
      ->group("Room");
  command.add_option("--teacher-seed", synth.teacher_seed, "seed of another simulated teacher for the same room")
      ->check(seed_number())
      ->group("Simulated priors");
  command.add_option("--teacher", options->teacher, "priors: exact, or with the errors of networks")
      ->check(CLI::IsMember({"exact", "simulated"}))
      ->capture_default_str()
      ->group("Simulated priors");
  command
      .add_option("--level", options->level,
                  "size of the simulated errors; medium imitates VGGT-1B, base and small DA3-Base and DA3-Small")
      ->check(CLI::IsMember(teacher_level_names()))
      ->capture_default_str()
      ->group("Simulated priors");
  command
      .add_option(
          "--depth", options->depth,
          "what pred_depths/ imitates: a network for many or for single photos, or a phone's time-of-flight sensor "
          "with its tracked cameras")
      ->check(CLI::IsMember({"feedforward", "mono", "sensor"}))
      ->capture_default_str()
      ->group("Simulated priors");
  command
      .add_option("--cloud", options->cloud,
                  "points: thinned dense depth, or corners triangulated with the same cameras")
      ->check(CLI::IsMember({"feedforward", "sfm"}))
      ->capture_default_str()
      ->group("Simulated priors");
  command.add_option("--labels", options->labels, "segmentation_logits/: of the teacher, true, or a placebo")
      ->check(CLI::IsMember({"teacher", "true", "constant", "shuffled"}))
      ->capture_default_str()
      ->group("Simulated priors");
  command
      .add_option("--segments", options->segments,
                  "segments/: things one by one, as a panoptic network tells them apart, true, or none")
      ->check(CLI::IsMember({"none", "teacher", "true"}))
      ->capture_default_str()
      ->group("Simulated priors");
  command
      .add_flag("--unknown-similarity", synth.unknown_similarity,
                "give the teacher's world an unknown scale and rotation, as real networks do")
      ->group("Simulated priors");
}

SynthOptions synth_options(const SynthCommandOptions& options) {
  SynthOptions synth = options.synth;
  if (!options.size.empty()) {
    char rest = 0;
    if (std::sscanf(options.size.c_str(), "%dx%d%c", &synth.width, &synth.height, &rest) != 2) {
      throw_usage("--size must be WxH, got \"" + options.size + "\"", "for example --size 640x480");
    }
  }
  synth.test_views = options.test_views.value_or(std::min(synth.test_views, synth.views / 3));
  if (synth.views - synth.test_views < 2) {
    throw_usage("of " + std::to_string(synth.views) + " views " + std::to_string(synth.test_views) +
                    " are test views: two must be left for training",
                "raise --views or lower --test-views");
  }
  synth.teacher = options.teacher == "exact" ? TeacherKind::kExact : TeacherKind::kSimulated;
  synth.level = parse_teacher_level(options.level);
  synth.depth_teacher = options.depth == "mono"     ? DepthTeacher::kMono
                        : options.depth == "sensor" ? DepthTeacher::kSensor
                                                    : DepthTeacher::kFeedForward;
  synth.exposure = options.exposure == "walk" ? ExposureKind::kWalk : ExposureKind::kPerPhoto;
  synth.segments = options.segments == "teacher" ? SegmentTeacher::kTeacher
                   : options.segments == "true"  ? SegmentTeacher::kTrue
                                                 : SegmentTeacher::kNone;
  synth.cloud = options.cloud == "sfm" ? CloudTeacher::kSfm : CloudTeacher::kFeedForward;
  for (const LabelTeacher teacher :
       {LabelTeacher::kTeacher, LabelTeacher::kTrue, LabelTeacher::kConstant, LabelTeacher::kShuffled}) {
    if (options.labels == label_teacher_name(teacher)) synth.labels = teacher;
  }
  return synth;
}

SynthScene make_scene(const SynthOptions& options, const CommandContext& context) {
  ThreadPool pool(context.global.threads);
  constexpr uint64_t kSteps = 1000;
  Progress progress(context.progress(), "synth", kSteps);
  return make_synth_scene(options, pool, [&](double share, const std::string& what) {
    progress.update(static_cast<uint64_t>(share * kSteps), what);
  });
}

}  // namespace aligngs
