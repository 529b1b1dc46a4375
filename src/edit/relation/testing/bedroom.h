// A bedroom of boxes: two beds with pillows, a chest of drawers with a lamp, a floor lamp, chairs, pictures and a rug.
#pragma once

#include "core/error.h"
#include "edit/meant_objects.h"
#include "edit/testing/small_room.h"

namespace aligngs::small_room {

/// Up is -y, and the cameras look along +z from the middle of the near side. +x is on the right.
class BedroomOfBoxes : public LabelledBoxes {
 protected:
  BedroomOfBoxes() {
    put("floor", {-2, -0.02f, 0}, {2, 0, 4});
    put("wall", {-2, -2.5f, 4}, {2, 0, 4.1f});
    put("bed", {-1.5f, -0.5f, 2.6f}, {-0.5f, 0, 3.96f});
    put("bed", {0.5f, -0.5f, 2.6f}, {1.5f, 0, 3.96f}, 2);
    put("pillow", {-1.2f, -0.62f, 3.4f}, {-0.8f, -0.5f, 3.7f});
    put("pillow", {0.6f, -0.62f, 3.4f}, {0.9f, -0.5f, 3.7f}, 2);
    put("pillow", {1.1f, -0.62f, 3.4f}, {1.4f, -0.5f, 3.7f}, 3);
    put("chest of drawers", {-0.3f, -0.8f, 3.5f}, {0.3f, 0, 3.96f});
    put("lamp", {-0.1f, -1.1f, 3.6f}, {0.1f, -0.8f, 3.8f});
    put("lamp", {-1.9f, -1.6f, 0.6f}, {-1.7f, 0, 0.8f}, 2);
    put("chair", {-1.5f, -0.9f, 0.5f}, {-1.1f, 0, 0.9f});
    put("chair", {1.2f, -0.8f, 0.5f}, {1.8f, 0, 1.1f}, 2);
    put("painting", {-1.3f, -1.8f, 3.92f}, {-0.7f, -1.3f, 3.98f});
    put("rug", {0.4f, -0.04f, 1.8f}, {1.6f, -0.02f, 3.4f});
  }
  void put(const char* name, const Vec3f& low, const Vec3f& high, int number = 1) {
    add(low, high, labels_.find(name), number);
  }
  RoomObjects objects() const { return RoomObjects(room_, labels_, viewpoint_, 1); }
  /// The selection with numbers.
  std::string meant(const std::string& text) const {
    const Vocabulary vocabulary(labels_);
    return selection_text(with_numbers(parse_selection(text, vocabulary), objects()), labels_);
  }
  /// Message and remedy of a selection that is refused.
  std::string refusal(const std::string& text) const {
    try {
      ADD_FAILURE() << text << " means " << meant(text);
    } catch (const Error& error) {
      return error.details().message + " | " + error.details().remedy;
    }
    return "";
  }

  LabelSet labels_ = ade20k_labels();
  Viewpoint viewpoint_{Vec3d{0, -1, 0}, Vec3d{0, -1.5, -1}};
};

}  // namespace aligngs::small_room
