// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "cia402_driver/bus/jobs.h"
#include "cia402_driver/bus/object_address.h"
#include "cia402_driver/bus/object_text.h"

namespace cia402::bus {
namespace {

using drive::CoordinateMark;

/// A drive may confirm a new zero before it counts from it.
constexpr Duration kSettling{std::chrono::milliseconds(250)};

/// What there is instead of writing the object.
std::string insteadOf(CoordinateMark mark, const std::string& axis) {
  switch (mark) {
    case CoordinateMark::set_position:
      return "the service ~" + axis + "/set_position says where the joint stands without it";
    case CoordinateMark::home:
      return "the service ~" + axis +
             "/home finds the zero, with homing/offset of the configuration";
    case CoordinateMark::restore_parameters:
      return "the service ~" + axis + "/restore_parameters does this";
    case CoordinateMark::configuration:
      return "give it in `write` of the axis' configuration, with `counts_per_turn`, `gear_ratio` "
             "and `direction` to match";
    case CoordinateMark::calibration:
    case CoordinateMark::none:
      break;
  }
  return "it is calibration, for which there is no service";
}

/// Offsets that a drive adds to each set-point (CiA 402-2: 60B0h, 60B1h, 60B2h; of further axes
/// 800h later): what is in them moves it, now or with the next set-point.
bool addsToSetPoints(fieldbus::ObjectId id) {
  constexpr unsigned kFirst = 0x60B0, kLast = 0x60B2, kAxisSize = 0x800, kEnd = 0xA000;
  if (id.index < kFirst || id.index >= kEnd) return false;
  return (id.index - kFirst) % kAxisSize <= kLast - kFirst;
}

std::string offsetRefusal(fieldbus::ObjectId id, const fieldbus::Bytes& data) {
  const bool nothing = std::all_of(data.begin(), data.end(), [](auto byte) { return byte == 0; });
  if (nothing || !addsToSetPoints(id)) return {};
  return "the drive adds it to each of its set-points, so that it would move by it though nobody "
         "commands that; add it to the set-points, and leave 0 here";
}

/// May the drive have taken it?
bool mayBeWritten(const fieldbus::Transfer& transfer) {
  return transfer.failure() != fieldbus::Transfer::Failure::aborted_by_server;
}

}  // namespace

Result<ObjectJob> ObjectJob::find(drive::Axis& axis, const std::string& object, Reply reply) {
  ObjectJob job;
  job.axis_ = &axis;
  job.reply_ = std::move(reply);
  job.who_ = drive::whoIs(axis.config());
  auto found = findObject(axis.config(), object);
  if (!found) return Error{job.who_ + ": " + found.error().message};
  job.id_ = found->id;
  job.spec_ = found->spec;
  job.name_ = found->title;
  std::string refusal = axis.device().askingRefusal(job.name_);
  if (!refusal.empty()) return Error{std::move(refusal)};
  return job;
}

Result<ObjectJob> ObjectJob::read(drive::Axis& axis, const std::string& object, Reply reply) {
  Result<ObjectJob> job = find(axis, object, std::move(reply));
  if (job) {
    job.value().ticket_ = axis.device().objects().upload(job.value().id_, job.value().name_);
  }
  return job;
}

Result<ObjectJob> ObjectJob::write(drive::Axis& axis, const std::string& object,
                                   const std::string& value, Reply reply) {
  Result<ObjectJob> found = find(axis, object, std::move(reply));
  if (!found) return found;
  ObjectJob& job = found.value();
  job.value_ = value;
  job.mark_ = axis.config().profile->coordinateMark(job.id_);
  const std::string refusal = job.calibrationRefusal();
  if (!refusal.empty()) return Error{job.who_ + ": " + job.name_ + " not written: " + refusal};
  if (!job.spec_) {
    job.stage_ = Stage::asking_size;
    job.ticket_ = axis.device().objects().upload(job.id_, job.name_);
    job.lock();
    return found;
  }
  const Result<fieldbus::Bytes> data = encodeObject(*job.spec_, value);
  if (!data) return Error{job.who_ + ": " + job.name_ + " not written: " + data.error().message};
  const std::string moves = offsetRefusal(job.id_, *data);
  if (!moves.empty()) return Error{job.who_ + ": " + job.name_ + " not written: " + moves};
  if (const auto& eds = axis.config().description) {
    const fieldbus::DictionaryEntry* entry = eds->dictionary.find(job.id_);
    const auto allowed =
        entry != nullptr ? fieldbus::checkWrite(*entry, *data, eds->file) : Result<void>();
    if (!allowed) {
      return Error{job.who_ + ": " + job.name_ + " not written: " + allowed.error().message};
    }
  }
  const std::string units = inJointUnits(*job.spec_, axis.config(), *data);
  if (!units.empty()) job.units_ = " (" + units + ")";
  job.lock();
  job.download(*data);
  return found;
}

void ObjectJob::lock() {
  if (mark_ == CoordinateMark::none) return;
  axis_->beginCalibration(name_);
  locked_ = true;
}

std::string ObjectJob::calibrationRefusal() const {
  if (mark_ == CoordinateMark::none) return {};
  const std::string why = axis_->calibrationRefusal();
  if (why.empty()) return {};
  return "it shifts the drive's coordinates or holds its calibration, and " + why +
         ". Instead: " + insteadOf(mark_, axis_->config().name);
}

/// What gives a drive another zero is not written twice.
void ObjectJob::download(const fieldbus::Bytes& data) {
  stage_ = Stage::writing;
  std::optional<fieldbus::AccessOptions> once;
  if (locked_) {
    once = axis_->device().times().access;
    once->retries = 0;
  }
  ticket_ = axis_->device().objects().download(id_, data, name_, once);
}

bool ObjectJob::step(Time now) {
  if (!ticket_->done()) return false;
  switch (stage_) {
    case Stage::settling:
    case Stage::measuring:
      return measure(now);
    case Stage::writing:
      return finishWrite(now);
    case Stage::reading:
    case Stage::asking_size:
      break;
  }
  const bool reading = stage_ == Stage::reading;
  if (ticket_->ok()) return reading ? finishRead() : writeWithAskedSize();
  return finish(false, who_ + ": " + name_ + (reading ? " not read: " : " not written: ") +
                           ticket_->reason());
}

bool ObjectJob::finishWrite(Time now) {
  if (locked_ && (ticket_->ok() || mayBeWritten(*ticket_))) {
    axis_->loseZero();
    stage_ = Stage::settling;
    since_ = now;
    return false;
  }
  if (ticket_->ok()) return finish(true, who_ + ": wrote " + value_ + " to " + name_ + units_);
  return finish(false, who_ + ": " + name_ + " not written: " + ticket_->reason());
}

/// The axis stays locked until what it measures counts in the new coordinates.
bool ObjectJob::measure(Time now) {
  if (stage_ == Stage::settling) {
    if (now < since_ + kSettling) return false;
    axis_->measureAnew();
    stage_ = Stage::measuring;
    since_ = now;
    return false;
  }
  const bool measured = axis_->state().feedback_valid;
  if (!measured && now < since_ + axis_->config().profile->timing.state_change) return false;
  const std::string& axis = axis_->config().name;
  std::string text = ticket_->ok()
                         ? who_ + ": wrote " + value_ + " to " + name_ + units_
                         : who_ + ": it is not known whether " + value_ + " was written to " +
                               name_ + " (" + ticket_->reason() + "); read it";
  text += "; " + drive::jointName(axis_->config()) +
          " is not homed any more, for its zero may be another now: ";
  if (mark_ == CoordinateMark::configuration) {
    text += "see that `counts_per_turn`, `gear_ratio` and `direction` fit the drive, then ";
  }
  text += "~" + axis + "/set_position";
  if (axis_->config().homing) text += " or ~" + axis + "/home";
  if (!measured) text += "; the drive has not told its position since";
  return finish(ticket_->ok(), std::move(text));
}

bool ObjectJob::finishRead() {
  const auto unnamed = unnamedObject();
  const ObjectText text = describeObject(unnamed ? &*unnamed
                                         : spec_ ? &*spec_
                                                 : nullptr,
                                         axis_->config(), ticket_->data());
  Answer answer;
  answer.success = true;
  answer.message = who_ + ": " + name_ + " is " + text.value;
  answer.data = ticket_->data();
  answer.number = text.number;
  answer.text = text.value;
  if (reply_) reply_(answer);
  return true;
}

std::optional<drive::ObjectSpec> ObjectJob::unnamedObject() const {
  if (spec_) return {};
  if (fieldbus::isStandardText(id_)) {
    drive::ObjectSpec text;
    text.id = id_;
    text.type = drive::DataType::visible_string;
    return text;
  }
  return axis_->config().profile->unnamedFloat(id_, ticket_->data().size());
}

bool ObjectJob::writeWithAskedSize() {
  const auto unnamed = unnamedObject();
  const Result<fieldbus::Bytes> data =
      unnamed ? encodeObject(*unnamed, value_) : encodeUnlisted(value_, ticket_->data().size());
  if (!data) return finish(false, who_ + ": " + name_ + " not written: " + data.error().message);
  const std::string moves = offsetRefusal(id_, *data);
  if (!moves.empty()) return finish(false, who_ + ": " + name_ + " not written: " + moves);
  download(*data);
  return false;
}

bool ObjectJob::finish(bool success, std::string message) {
  if (locked_) axis_->endCalibration();
  locked_ = false;
  Answer answer;
  answer.success = success;
  answer.message = std::move(message);
  if (reply_) reply_(answer);
  return true;
}

}  // namespace cia402::bus
