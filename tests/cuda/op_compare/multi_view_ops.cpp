#include "compare_ops.h"
#include "engine/cuda/testing/maps.h"
#include "engine/losses/testing/two_view_maps.h"

namespace aligngs::op_compare {

void compare_multi_view(cuda::DeviceContext& context, const BenchmarkRoom& room, OpTable& table) {
  testing_maps::TwoViewFixture f(room.width, room.height);
  f.settings.weight[Loss::kMultiViewGeometric] = f.settings.weight[Loss::kMultiViewPhotometric] = 1;
  const cuda::TestNeighbour neighbour{&f.other, {f.other_depth.begin(), f.other_depth.end()}, f.seed};
  const cuda::MapLossResult got = losses_on_device(context, f, neighbour), want = cuda::losses_on_cpu(f, neighbour);
  const cuda::CudaTolerance t;
  const char* op = "multi_view";
  table.compare_number(op, "geometric", got.terms[Loss::kMultiViewGeometric], want.terms[Loss::kMultiViewGeometric],
                       tight(t.relative_loss));
  table.compare_number(op, "photometric", got.terms[Loss::kMultiViewPhotometric],
                       want.terms[Loss::kMultiViewPhotometric], tight(t.relative_loss));
  // A pixel that comes home on one side alone, or a patch at its limit, changes its own gradient wholly. A sample of a
  // patch at a line of pixel centres changes it a little.
  table.compare(op, "d normal", got.gradients.normal, want.gradients.normal, with_two_view_flips(tight(t.gradient)));
  table.compare(op, "d distance", got.gradients.distance, want.gradients.distance,
                with_two_view_flips(tight(t.gradient)));
}

}  // namespace aligngs::op_compare
