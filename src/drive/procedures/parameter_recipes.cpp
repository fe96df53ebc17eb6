// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Saving and restoring parameters by objects of the maker.
#include <algorithm>
#include <vector>

#include "common/text.h"
#include "drive/procedures/parameter_step.h"
#include "drive/profile/object_value.h"

namespace cia402::drive {
namespace {

using fieldbus::Bytes;
using fieldbus::Ticket;

std::string titleOf(const ObjectSpec& object) {
  return object.name + " (" + fieldbus::toString(object.id) + ")";
}

/// Memory is slow, and what makes a drive do something is not written twice.
Ticket writeOnce(const Context& context, const ObjectSpec& object, std::int64_t number) {
  fieldbus::AccessOptions patient;
  patient.timeout = context.axis.profile().parameters.timeout;
  patient.retries = 0;
  return context.axis.device().objects().download(
      object.id, wireBytes(static_cast<std::uint64_t>(number), object.type), object.name, patient);
}

/// Waits until nothing forbids it. @return running, failed, or done: it may begin
Outcome awaitPermission(const Context& context, const char* verb) {
  const std::string refusal = parameterRefusal(context.axis, verb);
  if (!refusal.empty()) return Outcome::failed(refusal);
  if (context.axis.feedback().atStandstill()) return Outcome::done();
  context.show("waiting for rest", "the axis to be seen standing");
  return Outcome::running();
}

/// Reads what services have written, has the drive keep what is written, writes it again, and has
/// it keep nothing any more.
class SaveBySwitch final : public ParameterStep {
 public:
  Outcome advance(const Context& context) override {
    while (true) {
      if (ticket_ && !ticket_->done()) return Outcome::running();
      const Outcome outcome = next(context);
      if (!outcome.isRunning() || !ticket_ || !ticket_->done()) return outcome;
    }
  }
  std::string what() const override {
    if (done_.empty()) return "nothing, as no service has written a parameter of the maker";
    return done_ + (left_.empty() ? "" : ", but not " + left_ + ", which are none of the maker's");
  }

 private:
  enum class Stage { beginning, reading, opening, writing, closing };

  struct Item {
    ObjectId id;
    std::string title;
    Bytes data;
  };

  Outcome next(const Context& context) {
    switch (stage_) {
      case Stage::beginning: {
        const Outcome may = awaitPermission(context, "save");
        if (!may.isDone()) return may;
        choose(context.axis);
        if (items_.empty()) return Outcome::done();
        context.show("reading parameters", "the drive to tell what is to be saved");
        stage_ = Stage::reading;
        return read(context);
      }
      case Stage::reading:
        return takeRead(context);
      case Stage::opening:
        if (!ticket_->ok()) return Outcome::failed(failure(context));
        at_ = 0;
        stage_ = Stage::writing;
        return write(context);
      case Stage::writing:
        return takeWritten(context);
      case Stage::closing:
        break;
    }
    return close(context);
  }

  void choose(AxisCore& axis) {
    const DriveProfile& profile = axis.profile();
    const auto& commands = profile.parameters.recipes.commands;
    for (const ObjectId id : axis.basis().written) {
      const ObjectSpec* object = profile.find(id);
      const bool commands_it = object != nullptr && std::find(commands.begin(), commands.end(),
                                                              object->name) != commands.end();
      if (commands_it || profile.coordinateMark(id) == CoordinateMark::restore_parameters) continue;
      const std::string named = profile.parameter_names.nameOf(id);
      const std::string title = fieldbus::toString(id) + (named.empty() ? "" : " " + named) +
                                (object == nullptr ? "" : " " + object->name);
      if (id.index >= 0x2000 && id.index < 0x6000) {
        items_.push_back({id, title, {}});
      } else {
        append(left_, title, ", ");
      }
    }
  }

  Outcome read(const Context& context) {
    ticket_ = context.axis.device().objects().upload(items_[at_].id, items_[at_].title);
    return Outcome::running();
  }
  Outcome takeRead(const Context& context) {
    if (!ticket_->ok()) return Outcome::failed(failure(context));
    items_[at_].data = ticket_->data();
    if (++at_ < items_.size()) return read(context);
    const Outcome may = awaitPermission(context, "save");
    if (may.isFailed()) return may;
    context.show("saving parameters", "the drive to confirm what is saved");
    stage_ = Stage::opening;
    return turn(context, memory(context).on);
  }
  Outcome turn(const Context& context, std::int64_t number) {
    ticket_ = writeOnce(context, *context.axis.profile().find(memory(context).object), number);
    return Outcome::running();
  }
  Outcome write(const Context& context) {
    fieldbus::AccessOptions patient;
    patient.timeout = context.axis.profile().parameters.timeout;
    patient.retries = 0;
    ticket_ = context.axis.device().objects().download(items_[at_].id, items_[at_].data,
                                                       items_[at_].title, patient);
    return Outcome::running();
  }
  /// Whatever comes of it, what was opened for it is closed.
  Outcome takeWritten(const Context& context) {
    if (!ticket_->ok()) problem_ = failure(context);
    if (problem_.empty()) append(done_, items_[at_].title, ", ");
    if (problem_.empty() && ++at_ < items_.size()) return write(context);
    stage_ = Stage::closing;
    return turn(context, memory(context).off);
  }
  Outcome close(const Context& context) {
    if (problem_.empty() && !ticket_->ok()) problem_ = failure(context);
    if (!problem_.empty()) return Outcome::failed(problem_);
    context.axis.basis().written.clear();
    return Outcome::done();
  }

  static const ParameterRecipes::Memory& memory(const Context& context) {
    return context.axis.profile().parameters.recipes.memory;
  }
  std::string failure(const Context& context) const {
    return context.axis.who() + ": cannot save parameters: " + ticket_->message() +
           (done_.empty() ? "" : "; saved before that: " + done_);
  }

  Stage stage_ = Stage::beginning;
  std::vector<Item> items_;
  std::size_t at_ = 0;
  std::string done_, left_, problem_;
  Ticket ticket_;
};

class RestoreByObject final : public ParameterStep {
 public:
  Outcome advance(const Context& context) override {
    const DriveProfile& profile = context.axis.profile();
    const ParameterRecipes::Restore& recipe = profile.parameters.recipes.restore;
    const ObjectSpec& object = *profile.find(recipe.object);
    if (!ticket_) {
      const Outcome may = awaitPermission(context, "restore");
      if (!may.isDone()) return may;
      what_ = "all parameters by " + titleOf(object);
      context.show("restoring parameters", "the drive to confirm " + titleOf(object));
      ticket_ = writeOnce(context, object, recipe.value);
    }
    if (!ticket_->done()) return Outcome::running();
    const bool refused =
        !ticket_->ok() && ticket_->failure() == fieldbus::Transfer::Failure::aborted_by_server;
    if (!refused) loseZeros(context.axis);
    if (ticket_->ok()) return Outcome::done();
    return Outcome::failed(context.axis.who() +
                           ": cannot restore parameters: " + ticket_->message());
  }
  std::string what() const override { return what_; }

 private:
  Ticket ticket_;
  std::string what_;
};

}  // namespace

std::unique_ptr<ParameterStep> makeSaveBySwitch() { return std::make_unique<SaveBySwitch>(); }
std::unique_ptr<ParameterStep> makeRestoreByObject() { return std::make_unique<RestoreByObject>(); }

std::string restoreText(const DriveProfile& profile) {
  const ParameterRecipes::Restore& recipe = profile.parameters.recipes.restore;
  const std::string then = recipe.then.empty() ? "" : ": " + recipe.then;
  return titleOf(*profile.find(recipe.object)) + " = " + std::to_string(recipe.value) + then;
}

}  // namespace cia402::drive
