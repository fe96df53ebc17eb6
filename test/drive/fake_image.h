// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "cia402_driver/common/time.h"
#include "drive/fake_drive.h"
#include "fieldbus/process_image.h"

namespace cia402::drive::test {

/// An object that travels in the cycle.
struct Mapped {
  fieldbus::ObjectId object;
  unsigned bits = 0;
};

/// Objects that come or leave together.
struct Group {
  std::string name;  ///< for messages: "TPDO 1 (COB-ID 0x183)"
  std::vector<Mapped> objects;
  bool every_cycle = true;    ///< an input that comes with each cycle, else on change
  unsigned stale_after = 10;  ///< cycles without it
  bool by_test = false;       ///< the drive does not send it: it comes by Bench::bring() only
};

/// What travels between the driver and a device.
struct Layout {
  std::vector<Group> outputs, inputs;
};

/// A process image without a bus: the groups come and leave as the device says.
class FakeImage final : public fieldbus::ProcessImage {
 public:
  explicit FakeImage(const Layout& layout) {
    for (const Group& group : layout.inputs) inputs_.push_back({group, {}});
    for (const Group& group : layout.outputs) outputs_.push_back({group, {}});
    for (Input& input : inputs_) {
      for (const Mapped& mapped : input.group.objects) {
        const fieldbus::Slot slot = addInput(mapped.object);
        const bool cycles = input.group.every_cycle;
        setDelivery(slot, {cycles, cycles ? std::uint16_t{1} : std::uint16_t{0}, Duration::zero()});
        input.fields.push_back({slot, mapped});
      }
    }
    for (std::size_t i = 0; i < outputs_.size(); ++i) {
      for (const Mapped& mapped : outputs_[i].group.objects) {
        const fieldbus::Slot slot = addOutput(mapped.object);
        setCarrier(slot, i);
        outputs_[i].fields.push_back({slot, mapped});
      }
    }
  }

  /// A group comes, with what is in it of `values`. @param by_test or from the drive
  void bring(const Values& values, bool by_test, Time now) {
    for (Input& input : inputs_) {
      if (input.group.by_test && !by_test) continue;
      for (const Field& field : input.fields) {
        const auto value = std::find_if(values.begin(), values.end(), [&](const Value& brought) {
          return brought.object == field.mapped.object;
        });
        if (value == values.end()) continue;
        take(field.slot, value->raw & maskOf(field.mapped), now);
        input.silent = 0;
        input.stale = false;
      }
    }
  }
  /// One cycle more without what did not come.
  void age() {
    for (Input& input : inputs_) {
      ++input.silent;
      const bool overdue = input.group.every_cycle && input.silent > input.group.stale_after;
      if (input.stale || !overdue) continue;
      input.stale = true;
      for (const Field& field : input.fields) outdate(field.slot);
    }
  }
  void sendAgain(fieldbus::Slot) override {}  // each leaves in each cycle anyway
  /// Every output group leaves. @return what is in them
  Values leave() {
    Values values;
    for (std::size_t i = 0; i < outputs_.size(); ++i) {
      if (outputs_[i].fields.empty()) continue;
      for (const Field& field : outputs_[i].fields) {
        values.push_back({field.mapped.object, output(field.slot) & maskOf(field.mapped)});
      }
      countSent(i);
    }
    return values;
  }
  /// The device turns out not to take this output.
  void leaveOut(fieldbus::ObjectId object) {
    for (Output& output : outputs_) {
      const auto gone =
          std::find_if(output.fields.begin(), output.fields.end(),
                       [&](const Field& field) { return field.mapped.object == object; });
      if (gone == output.fields.end()) continue;
      leaveOutOutput(gone->slot, true);
      output.fields.erase(gone);
    }
  }
  /// The device starts anew.
  void invalidate() {
    clear();
    for (Input& input : inputs_) {
      input.silent = 0;
      input.stale = false;
    }
  }

  std::string overdueText() const {
    return text([](const Input& input) {
      return " did not come for " + std::to_string(input.silent) + " cycles";
    });
  }
  std::string missingText() const {
    return text([](const Input&) { return std::string(" does not come"); });
  }
  const std::string& carrierText(fieldbus::Slot slot) const {
    return outputs_[carrierOf(slot)].group.name;
  }

 private:
  struct Field {
    fieldbus::Slot slot;
    Mapped mapped;
  };
  struct Input {
    Group group;
    std::vector<Field> fields;
    unsigned silent = 0;  ///< cycles since it came
    bool stale = false;
  };
  struct Output {
    Group group;
    std::vector<Field> fields;
  };

  static std::uint64_t maskOf(const Mapped& mapped) {
    return (std::uint64_t{1} << mapped.bits) - 1;
  }
  template <typename Words>
  std::string text(Words words) const {
    std::string text;
    for (const Input& input : inputs_) {
      if (input.stale) text += (text.empty() ? "" : ", ") + input.group.name + words(input);
    }
    return text;
  }

  std::vector<Input> inputs_;
  std::vector<Output> outputs_;
};

}  // namespace cia402::drive::test
