#include "engine/cpu/semantic_view.h"

#include "engine/formulas/semantic_loss.h"
#include "engine/formulas/teacher_sampling.h"
#include "scene/triangle_mesh.h"

namespace aligngs::cpu {

void prepare_semantic_view(const TrainingView& view, ThreadPool& pool, SemanticView& out) {
  const SemanticTarget& target = view.data.semantics;
  const int width = view.data.camera.width, height = view.data.camera.height;
  out.negative_entropy.assign(size_t(width) * height, 0.0f);
  out.top_class.assign(size_t(width) * height, kNoLabel);
  std::vector<size_t> valid(static_cast<size_t>(height), 0);
  pool.parallel_for(static_cast<size_t>(height), 8, [&](size_t begin, size_t end, int) {
    std::vector<float> teacher(static_cast<size_t>(target.channels));
    for (size_t y = begin; y < end; ++y) {
      for (int x = 0; x < width; ++x) {
        const TeacherTaps taps = teacher_taps(target, x, static_cast<int>(y), width, height);
        if (!semantic_pixel_valid(view.data, taps, x, static_cast<int>(y))) continue;
        sample_teacher(target, taps, teacher.data());
        out.negative_entropy[y * width + x] = negative_entropy(teacher.data(), target.channels);
        out.top_class[y * width + x] = static_cast<uint16_t>(arg_max(teacher.data(), target.channels));
        ++valid[y];
      }
    }
  });
  out.valid = 0;
  for (const size_t n : valid) out.valid += n;
  out.ready = true;
}

}  // namespace aligngs::cpu
