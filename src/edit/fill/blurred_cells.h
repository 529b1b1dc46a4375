// Smooth means over the cells of a grid.
#pragma once

#include <vector>

namespace aligngs {

/// Blurs `columns` x `rows` values about as a Gaussian of standard deviation `sigma` cells does, at least one. Three
/// running means take its place (Wells 1986). Outside are zeros: who wants means of known cells divides by their blurred
/// mask.
void blur_cells(std::vector<float>& values, int columns, int rows, double sigma);

}  // namespace aligngs
