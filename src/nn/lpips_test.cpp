#include "nn/lpips.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "nn/testing/weights.h"

namespace aligngs::nn {
namespace {

const std::vector<std::vector<int>> kStages = {{0, 2}, {5, 7}, {10, 12, 14}, {17, 19, 21}, {24, 26, 28}};
const std::vector<int64_t> kWidths = {4, 6, 8, 5, 7};  // narrow, for speed

TensorList vgg_tensors() {
  TensorList list;
  int64_t inputs = 3;
  for (size_t s = 0; s < kStages.size(); ++s) {
    for (const int index : kStages[s]) {
      const std::string name = "features." + std::to_string(index);
      list.push_back({name + ".weight", {kWidths[s], inputs, 3, 3}});
      list.push_back({name + ".bias", {kWidths[s]}});
      inputs = kWidths[s];
    }
  }
  return list;
}

TensorList linear_tensors() {
  TensorList list;
  for (size_t s = 0; s < kWidths.size(); ++s)
    list.push_back({"lin" + std::to_string(s) + ".model.1.weight", {1, kWidths[s], 1, 1}});
  return list;
}

ImageF random_picture(int width, int height, uint64_t seed) {
  ImageF image(width, height, 3);
  Random random(seed);
  for (float& v : image.data) v = float(random.uniform());
  return image;
}

/// Planes of doubles, and the definition written out plainly.
using Planes = std::vector<std::vector<double>>;

struct PlainLpips {
  const MemoryWeights& vgg;
  int width = 0, height = 0;

  Planes convolve(const Planes& x, int index) const {
    const std::string name = "features." + std::to_string(index);
    const std::vector<float> w = vgg.read(name + ".weight"), b = vgg.read(name + ".bias");
    Planes y(b.size(), std::vector<double>(size_t(width * height)));
    for (size_t o = 0; o < y.size(); ++o) {
      for (int p = 0; p < width * height; ++p) {
        double sum = double(b[o]);
        for (size_t i = 0; i < x.size(); ++i) {
          for (int t = 0; t < 9; ++t) {
            const int v = p / width + t / 3 - 1, u = p % width + t % 3 - 1;
            if (v < 0 || u < 0 || v >= height || u >= width) continue;
            sum += double(w[(o * x.size() + i) * 9 + size_t(t)]) * x[i][size_t(v * width + u)];
          }
        }
        y[o][size_t(p)] = std::max(sum, 0.0);
      }
    }
    return y;
  }
  Planes pool(const Planes& x) {
    Planes y(x.size());
    for (size_t c = 0; c < x.size(); ++c) {
      for (int v = 0; v + 1 < height; v += 2) {
        for (int u = 0; u + 1 < width; u += 2) {
          const auto at = [&](int dv, int du) { return x[c][size_t((v + dv) * width + u + du)]; };
          y[c].push_back(std::max({at(0, 0), at(0, 1), at(1, 0), at(1, 1)}));
        }
      }
    }
    width /= 2;
    height /= 2;
    return y;
  }
};

double plain_distance(const MemoryWeights& vgg, const MemoryWeights& linear, const ImageF& a, const ImageF& b,
                      bool canonical) {
  PlainLpips plain{vgg, a.width, a.height};
  const double shift[3] = {-0.030, -0.088, -0.188}, scale[3] = {0.458, 0.448, 0.450};
  const auto planes_of = [&](const ImageF& image) {
    Planes planes(3);
    for (size_t i = 0; i < image.data.size(); ++i) {
      const double x = canonical ? 2 * double(image.data[i]) - 1 : double(image.data[i]);
      planes[i % 3].push_back((x - shift[i % 3]) / scale[i % 3]);
    }
    return planes;
  };
  Planes xa = planes_of(a), xb = planes_of(b);
  double total = 0;
  for (size_t s = 0; s < kStages.size(); ++s) {
    if (s > 0) {
      PlainLpips same = plain;
      xa = same.pool(xa);
      xb = plain.pool(xb);
    }
    for (const int index : kStages[s]) {
      xa = plain.convolve(xa, index);
      xb = plain.convolve(xb, index);
    }
    const std::vector<float> w = linear.read("lin" + std::to_string(s) + ".model.1.weight");
    const size_t places = xa[0].size();
    for (size_t p = 0; p < places; ++p) {
      double la = 0, lb = 0, sum = 0;
      for (size_t c = 0; c < w.size(); ++c) {
        la += xa[c][p] * xa[c][p];
        lb += xb[c][p] * xb[c][p];
      }
      for (size_t c = 0; c < w.size(); ++c) {
        const double d = xa[c][p] / (std::sqrt(la) + 1e-10) - xb[c][p] / (std::sqrt(lb) + 1e-10);
        sum += double(w[c]) * d * d;
      }
      total += sum / double(places);
    }
  }
  return total;
}

class LpipsTest : public testing::Test {
 protected:
  ThreadPool pool_{2};
  Compute compute_{pool_};
  std::shared_ptr<MemoryWeights> vgg_ = MemoryWeights::random(vgg_tensors());
  std::shared_ptr<MemoryWeights> linear_ = MemoryWeights::random(linear_tensors());
};

TEST_F(LpipsTest, IsItsDefinition) {
  const Lpips lpips(compute_, Weights(vgg_), Weights(linear_));
  const ImageF a = random_picture(21, 18, 1), b = random_picture(21, 18, 2);
  for (const bool canonical : {true, false}) {
    const double expected = plain_distance(*vgg_, *linear_, a, b, canonical);
    const auto input = canonical ? LpipsInput::kCanonical : LpipsInput::kUnit;
    EXPECT_NEAR(lpips.distance(compute_, a, b, input), expected, 1e-5 * std::abs(expected));
  }
}

TEST_F(LpipsTest, EqualImagesHaveDistanceZero) {
  const Lpips lpips(compute_, Weights(vgg_), Weights(linear_));
  const ImageF a = random_picture(32, 16, 1);
  EXPECT_EQ(lpips.distance(compute_, a, a, LpipsInput::kCanonical), 0);
}

TEST_F(LpipsTest, RefusesImagesThatDoNotMatch) {
  const Lpips lpips(compute_, Weights(vgg_), Weights(linear_));
  const ImageF a = random_picture(32, 16, 1);
  for (const ImageF& b : {random_picture(16, 32, 1), random_picture(32, 17, 1)})
    EXPECT_THROW(lpips.distance(compute_, a, b, LpipsInput::kUnit), Error);
  const ImageF small = random_picture(15, 32, 1);
  EXPECT_THROW(lpips.distance(compute_, small, small, LpipsInput::kUnit), Error);
}

TEST_F(LpipsTest, MissingWeightsAreNamed) {
  vgg_->forget("features.28.weight");
  try {
    Lpips(compute_, Weights(vgg_), Weights(linear_));
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kWeights);
    EXPECT_EQ(error.details().field, "features.28.weight");
  }
}

}  // namespace
}  // namespace aligngs::nn
