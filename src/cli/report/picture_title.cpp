#include "cli/report/picture_title.h"

#include <array>

namespace aligngs {
namespace {

constexpr int kColumns = 5, kGlyphRows = 7, kScale = 2, kAdvance = (kColumns + 1) * kScale, kMargin = 4;
constexpr int kTail = 1;  // rows below the line
constexpr uint8_t kInk = 40;

/// Rows from the top, five bits each, the highest on the left. Letters with a tail (g, j, p, q, y) are drawn a row
/// lower.
using Glyph = std::array<uint8_t, kGlyphRows>;
constexpr std::array<Glyph, 26> kLetters = {{
    {0b00000, 0b00000, 0b01110, 0b00001, 0b01111, 0b10001, 0b01111},  // a
    {0b10000, 0b10000, 0b11110, 0b10001, 0b10001, 0b10001, 0b11110},  // b
    {0b00000, 0b00000, 0b01110, 0b10000, 0b10000, 0b10001, 0b01110},  // c
    {0b00001, 0b00001, 0b01111, 0b10001, 0b10001, 0b10001, 0b01111},  // d
    {0b00000, 0b00000, 0b01110, 0b10001, 0b11111, 0b10000, 0b01110},  // e
    {0b00110, 0b01001, 0b01000, 0b11100, 0b01000, 0b01000, 0b01000},  // f
    {0b00000, 0b01111, 0b10001, 0b10001, 0b01111, 0b00001, 0b01110},  // g
    {0b10000, 0b10000, 0b10110, 0b11001, 0b10001, 0b10001, 0b10001},  // h
    {0b00100, 0b00000, 0b01100, 0b00100, 0b00100, 0b00100, 0b01110},  // i
    {0b00010, 0b00000, 0b00110, 0b00010, 0b00010, 0b10010, 0b01100},  // j
    {0b10000, 0b10000, 0b10010, 0b10100, 0b11000, 0b10100, 0b10010},  // k
    {0b01100, 0b00100, 0b00100, 0b00100, 0b00100, 0b00100, 0b01110},  // l
    {0b00000, 0b00000, 0b11010, 0b10101, 0b10101, 0b10101, 0b10101},  // m
    {0b00000, 0b00000, 0b10110, 0b11001, 0b10001, 0b10001, 0b10001},  // n
    {0b00000, 0b00000, 0b01110, 0b10001, 0b10001, 0b10001, 0b01110},  // o
    {0b00000, 0b11110, 0b10001, 0b10001, 0b11110, 0b10000, 0b10000},  // p
    {0b00000, 0b01111, 0b10001, 0b10001, 0b01111, 0b00001, 0b00001},  // q
    {0b00000, 0b00000, 0b10110, 0b11001, 0b10000, 0b10000, 0b10000},  // r
    {0b00000, 0b00000, 0b01111, 0b10000, 0b01110, 0b00001, 0b11110},  // s
    {0b01000, 0b01000, 0b11100, 0b01000, 0b01000, 0b01001, 0b00110},  // t
    {0b00000, 0b00000, 0b10001, 0b10001, 0b10001, 0b10011, 0b01101},  // u
    {0b00000, 0b00000, 0b10001, 0b10001, 0b10001, 0b01010, 0b00100},  // v
    {0b00000, 0b00000, 0b10001, 0b10101, 0b10101, 0b10101, 0b01010},  // w
    {0b00000, 0b00000, 0b10001, 0b01010, 0b00100, 0b01010, 0b10001},  // x
    {0b00000, 0b10001, 0b10001, 0b10001, 0b01111, 0b00001, 0b01110},  // y
    {0b00000, 0b00000, 0b11111, 0b00010, 0b00100, 0b01000, 0b11111},  // z
}};

void draw_letter(Image<uint8_t>& picture, int x0, int y0, const Glyph& glyph) {
  for (int y = 0; y < kGlyphRows * kScale; ++y) {
    for (int x = 0; x < kColumns * kScale; ++x) {
      const bool ink = (glyph[size_t(y / kScale)] >> (kColumns - 1 - x / kScale)) & 1;
      if (!ink || x0 + x < 0 || y0 + y < 0 || x0 + x >= picture.width || y0 + y >= picture.height) continue;
      for (int c = 0; c < picture.channels; ++c) picture.at(x0 + x, y0 + y, c) = kInk;
    }
  }
}

}  // namespace

void draw_title(Image<uint8_t>& picture, int x0, int y0, std::string_view title) {
  int x = x0 + kMargin;
  for (const char letter : title) {
    const int tail = std::string_view("gjpqy").find(letter) == std::string_view::npos ? 0 : kTail;
    if (letter >= 'a' && letter <= 'z')
      draw_letter(picture, x, y0 + (kTitleHeight - kGlyphRows * kScale) / 2 + tail * kScale,
                  kLetters[size_t(letter - 'a')]);
    x += kAdvance;
  }
}

}  // namespace aligngs
