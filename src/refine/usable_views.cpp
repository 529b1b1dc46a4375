#include "refine/usable_views.h"

#include "core/error.h"
#include "io/left_out.h"
#include "scene/view_data.h"

namespace aligngs {

void load_usable_views(Scene& scene, const std::function<void()>& load) {
  try {
    load();
    return;
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::kBadInput) throw;
    const size_t before = scene.left_out.size();
    leave_out_bad_views(scene, check_scene(scene));
    if (scene.left_out.size() == before) throw;
  }
  warn_left_out(scene.train.size() + scene.test.size(), scene.left_out, "views");
  load();
}

}  // namespace aligngs
