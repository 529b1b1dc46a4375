#include "priors/test_photos.h"

#include <fmt/format.h>

#include <string>

#include "core/error.h"
#include "scene/scene.h"

namespace aligngs {
namespace {

size_t training_photos(size_t photos, int test_every) {
  const auto step = static_cast<size_t>(test_every);
  return photos - (photos + step - 1) / step;
}

}  // namespace

void require_training_photos(const std::filesystem::path& source, size_t photos, int test_every) {
  if (photos == 0 || test_every <= 0) return;
  const size_t kept = training_photos(photos, test_every);
  if (kept >= kFewestTrainingViews) return;
  std::string remedy = "leave --test-every out";
  for (int larger = 1; larger <= static_cast<int>(kFewestTrainingViews) + 1; ++larger) {
    if (training_photos(photos, larger) < kFewestTrainingViews) continue;
    remedy = fmt::format("use --test-every {} or more, or leave it out", larger);
    break;
  }
  throw_bad_input(
      source, fmt::format("--test-every {}", test_every),
      fmt::format("this leaves {} of {} photos for training, and {} are needed", kept, photos, kFewestTrainingViews),
      remedy);
}

}  // namespace aligngs
