// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/jobs/object_job.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "bus/axis_cycle.h"
#include "bus/jobs/object_address.h"
#include "bus/jobs/object_text.h"
#include "drive/axis/coordinates.h"
#include "drive/profile/object_value.h"

namespace cia402::bus {
namespace {

using drive::CoordinateMark;

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
  const std::optional<unsigned> axis = drive::axisOf(id);
  if (!axis) return false;
  const unsigned index = id.index - *axis * drive::kAxisSize;
  return index >= 0x60B0 && index <= 0x60B2;
}

std::string offsetRefusal(fieldbus::ObjectId id, const fieldbus::Bytes& data) {
  const bool nothing = std::all_of(data.begin(), data.end(), [](auto byte) { return byte == 0; });
  if (nothing || !addsToSetPoints(id)) return {};
  return "the drive adds it to each of its set-points, so that it would move by it though nobody "
         "commands that; add it to the set-points, and leave 0 here";
}

/// Why the description of the device forbids the write; empty if it does not.
std::string descriptionRefusal(const drive::AxisConfig& axis, fieldbus::ObjectId id,
                               const fieldbus::Bytes& data) {
  const auto& description = axis.description;
  const fieldbus::DictionaryEntry* entry = description ? description->dictionary.find(id) : nullptr;
  if (entry == nullptr) return {};
  const auto allowed = fieldbus::checkWrite(*entry, data, description->file);
  return allowed ? std::string() : allowed.error().message;
}

/// May the drive have taken it?
bool mayBeWritten(const fieldbus::Transfer& transfer) {
  return transfer.failure() != fieldbus::Transfer::Failure::aborted_by_server;
}

}  // namespace

void ReadObjectCommand::begin(AxisCycle& cycle, const Reply<ObjectAnswer>& reply, Time) const {
  AxisUnit* const unit = cycle.find(axis);
  if (unit == nullptr) return refuse(reply, noSuchAxis(axis));
  auto job = ObjectJob::read(unit->axis, object, reply);
  if (!job) return refuse(reply, job.error().message);
  cycle.jobs().add(std::move(job).value());
}

void WriteObjectCommand::begin(AxisCycle& cycle, const Reply<>& reply, Time) const {
  AxisUnit* const unit = cycle.find(axis);
  if (unit == nullptr) return refuse(reply, noSuchAxis(axis));
  auto job = ObjectJob::write(unit->axis, object, value, reply);
  if (!job) return refuse(reply, job.error().message);
  cycle.jobs().add(std::move(job).value());
}

ObjectJob::ObjectJob(drive::Axis& axis, Reply<ObjectAnswer> reply)
    : Job(Turn::object, Ends::with_motion),
      axis_(&axis),
      who_(drive::whoIs(axis.config())),
      reply_(std::move(reply)) {}

std::string ObjectJob::find(const std::string& object) {
  const auto found = findObject(axis_->config(), object);
  if (!found) return who_ + ": " + found.error().message;
  id_ = found->id;
  spec_ = found->spec;
  name_ = found->title;
  return axis_->device().askingRefusal(name_);
}

Result<std::unique_ptr<Job>> ObjectJob::read(drive::Axis& axis, const std::string& object,
                                             Reply<ObjectAnswer> reply) {
  std::unique_ptr<ObjectJob> job(new ObjectJob(axis, std::move(reply)));
  const std::string refusal = job->find(object);
  if (!refusal.empty()) return Error{refusal};
  job->ticket_ = axis.device().objects().upload(job->id_, job->name_);
  return std::unique_ptr<Job>(std::move(job));
}

Result<std::unique_ptr<Job>> ObjectJob::write(drive::Axis& axis, const std::string& object,
                                              const std::string& value, Reply<ObjectAnswer> reply) {
  std::unique_ptr<ObjectJob> job(new ObjectJob(axis, std::move(reply)));
  std::string refusal = job->find(object);
  if (refusal.empty()) refusal = job->beginWrite(value);
  if (!refusal.empty()) return Error{refusal};
  return std::unique_ptr<Job>(std::move(job));
}

std::string ObjectJob::notWritten(const std::string& why) const {
  return who_ + ": " + name_ + " not written: " + why;
}

std::string ObjectJob::beginWrite(const std::string& value) {
  value_ = value;
  mark_ = axis_->config().profile->coordinateMark(id_);
  std::string refusal = strangerRefusal();
  if (refusal.empty()) refusal = drive::doubtOf(axis_->config(), id_);
  if (refusal.empty()) refusal = calibrationRefusal();
  if (refusal.empty()) refusal = powerRefusal();
  if (!refusal.empty()) return notWritten(refusal);
  if (!spec_) {
    stage_ = Stage::asking_size;
    ticket_ = axis_->device().objects().upload(id_, name_);
    lock();
    return {};
  }
  const Result<std::string> counted = countedValue();
  if (!counted) return notWritten(counted.error().message);
  const Result<fieldbus::Bytes> data = encodeObject(*spec_, *counted);
  if (!data) return notWritten(data.error().message);
  std::string forbidden = offsetRefusal(id_, *data);
  if (forbidden.empty()) forbidden = descriptionRefusal(axis_->config(), id_, *data);
  if (!forbidden.empty()) return notWritten(forbidden);
  const std::string units = inJointUnits(*spec_, axis_->config(), *data);
  if (!units.empty()) units_ = " (" + units + ")";
  lock();
  download(*data);
  return {};
}

/// A number with a point is one as the manual prints it.
Result<std::string> ObjectJob::countedValue() const {
  const bool is_float = spec_ && drive::holdsFloat(spec_->type, spec_->encoding);
  if (is_float) return value_;
  return axis_->config().profile->parameter_names.counted(id_, value_);
}

void ObjectJob::lock() {
  if (mark_ == CoordinateMark::none) return;
  axis_->beginCalibration(name_);
  locked_ = true;
}

/// Nobody moves an axis through the name of another one.
std::string ObjectJob::strangerRefusal() const {
  const std::optional<unsigned> owner = drive::axisOf(id_);
  if (!owner || *owner == axis_->config().device_axis) return {};
  return "it is of axis " + std::to_string(*owner) +
         " of the drive (CiA 402-2), and this is axis " +
         std::to_string(axis_->config().device_axis) +
         "; write it by the name of that axis, which has `device_axis: " + std::to_string(*owner) +
         "` in the configuration";
}

std::string ObjectJob::calibrationRefusal() const {
  if (mark_ == CoordinateMark::none) return {};
  std::string why = axis_->calibrationRefusal();
  if (why.empty() && ofDevice()) why = axis_->deviceRefusal();
  if (why.empty()) return {};
  return "it shifts the drive's coordinates or holds its calibration, and " + why +
         ". Instead: " + insteadOf(mark_, axis_->config().name);
}

std::string ObjectJob::powerRefusal() const {
  if (!spec_ || !spec_->when_disabled || mark_ != CoordinateMark::none) return {};
  const std::string why = axis_->calibrationRefusal();
  return why.empty() ? why : "the drive takes it while it is switched off only, and " + why;
}

/// What gives a drive another zero is not written twice.
void ObjectJob::download(const fieldbus::Bytes& data) {
  stage_ = Stage::writing;
  written_ = data;
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
    case Stage::reading_back:
      return compare();
    case Stage::reading:
    case Stage::asking_size:
      break;
  }
  const bool reading = stage_ == Stage::reading;
  if (ticket_->ok()) return reading ? finishRead() : writeWithAskedSize();
  return finish(false, reading ? who_ + ": " + name_ + " not read: " + ticket_->reason()
                               : notWritten(ticket_->reason()));
}

bool ObjectJob::finishWrite(Time now) {
  if (ticket_->ok()) axis_->noteWritten(id_);
  if (locked_ && (ticket_->ok() || mayBeWritten(*ticket_))) {
    axis_->loseZero(ofDevice());
    stage_ = Stage::settling;
    since_ = now;
    return false;
  }
  if (ticket_->ok()) return finishOrReadBack(writtenText(), {});
  return finish(false, notWritten(ticket_->reason()));
}

/// @param consequence of the write, behind what was written
bool ObjectJob::finishOrReadBack(std::string written, const std::string& consequence) {
  if (!readsBack()) return finish(true, written + consequence);
  stage_ = Stage::reading_back;
  said_ = std::move(written);
  consequence_ = consequence;
  written_ = ticket_->data();  // as the drive has it, if it has fewer bits for it
  ticket_ = axis_->device().objects().upload(id_, name_);
  return false;
}

std::string ObjectJob::writtenText() const {
  const bool later = axis_->config().profile->after_power.find(id_) != nullptr;
  return who_ + ": wrote " + value_ + " to " + name_ + units_ +
         (later ? "; it counts once the drive was switched off and on" : "");
}

/// What travels in the cycle as well is what that says by now.
bool ObjectJob::readsBack() const {
  const bool mapped = axis_->device().image().outputSlot(id_) != fieldbus::kNoSlot;
  const bool number = spec_ && spec_->readable && fieldbus::sizeBits(spec_->type) != 0;
  // What is a command, or moves by itself, is another number by now.
  const bool command =
      mark_ == CoordinateMark::set_position || mark_ == CoordinateMark::restore_parameters;
  return axis_->config().profile->reads_back && number && !mapped && !command;
}

/// What cannot be read again is believed.
bool ObjectJob::compare() {
  const fieldbus::Bytes& holds = ticket_->data();
  const bool same = !ticket_->ok() || holds.empty() || holds.size() > 8 ||
                    fieldbus::toUnsigned(holds) == fieldbus::toUnsigned(written_);
  if (same) return finish(true, said_ + consequence_);
  const ObjectText text = describeObject(&*spec_, axis_->config(), holds);
  return finish(false, who_ + ": wrote " + value_ + " to " + name_ + units_ + ", but it is " +
                           text.value + " when it is read back" + consequence_);
}

/// The axis stays locked until what it measures counts in the new coordinates.
bool ObjectJob::measure(Time now) {
  if (stage_ == Stage::settling) {
    if (now < since_ + drive::kZeroSettles) return false;
    axis_->measureAnew(ofDevice());
    stage_ = Stage::measuring;
    since_ = now;
    return false;
  }
  const bool measured = axis_->state().feedback_valid;
  if (!measured && now < since_ + axis_->config().profile->timing.state_change) return false;
  if (ticket_->ok()) return finishOrReadBack(writtenText(), unhomedText(measured));
  return finish(false, who_ + ": it is not known whether " + value_ + " was written to " + name_ +
                           " (" + ticket_->reason() + "); read it" + unhomedText(measured));
}

std::string ObjectJob::unhomedText(bool measured) const {
  const drive::AxisConfig& axis = axis_->config();
  std::string text =
      "; " + drive::jointName(axis) + " is not homed any more, for its zero may be another now: ";
  if (mark_ == CoordinateMark::configuration) {
    text += "see that `counts_per_turn`, `gear_ratio` and `direction` fit the drive, then ";
  }
  text += "~" + axis.name + "/set_position";
  if (axis.homing) text += " or ~" + axis.name + "/home";
  if (!measured) text += "; the drive has not told its position since";
  return text;
}

bool ObjectJob::finishRead() {
  if (spec_ && !spec_->high.empty() && !joinHalves()) return false;
  const auto unnamed = unnamedObject();
  const fieldbus::Bytes& data = joined_.empty() ? ticket_->data() : joined_;
  const ObjectText text = describeObject(unnamed ? &*unnamed
                                         : spec_ ? &*spec_
                                                 : nullptr,
                                         axis_->config(), data);
  ObjectAnswer answer;
  answer.success = true;
  answer.data = data;
  answer.number = text.number;
  answer.text = text.value + printedText(text.number);
  answer.message = who_ + ": " + name_ + " is " + answer.text;
  give(reply_, answer);
  return true;
}

/// ", printed as 48.0", where neither a unit nor a word says more of it.
std::string ObjectJob::printedText(double number) const {
  const bool measures = spec_ && spec_->quantity != drive::Quantity::none;
  if (measures || !std::isfinite(number)) return {};
  const std::string printed =
      axis_->config().profile->parameter_names.printed(id_, static_cast<std::int64_t>(number));
  return printed.empty() ? printed : ", in the manual " + printed;
}

/// A number in two objects: the lower half is read once more behind the upper one, which fits it
/// where it has not gone round meanwhile. @return false: one of them is asked for
bool ObjectJob::joinHalves() {
  const std::uint64_t half = fieldbus::toUnsigned(ticket_->data()) & 0xFFFFFFFFU;
  const drive::ObjectSpec* high = axis_->config().profile->find(spec_->high);
  halves_.push_back(half);
  const bool round = halves_.size() == 3 && (halves_[0] >> 31U) != (halves_[2] >> 31U);
  if (round) halves_ = {half};
  if (halves_.size() < 3) {
    const bool upper = halves_.size() == 1;
    ticket_ = axis_->device().objects().upload(upper ? high->id : id_, upper ? high->name : name_);
    return false;
  }
  joined_ = fieldbus::toBytes(halves_[1] << 32U | half, 8);
  spec_->type = drive::DataType::int64;
  spec_->high.clear();
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
  const drive::DriveProfile& profile = *axis_->config().profile;
  if (const auto number = profile.unnamedFloat(id_, ticket_->data().size())) return number;
  const auto type = profile.parameter_names.typeOf(id_, ticket_->data().size());
  if (!type) return {};
  drive::ObjectSpec number;
  number.id = id_;
  number.type = *type;
  return number;
}

bool ObjectJob::writeWithAskedSize() {
  const auto unnamed = unnamedObject();
  units_ = " (it was " +
           describeObject(unnamed ? &*unnamed : nullptr, axis_->config(), ticket_->data()).value +
           ")";
  const Result<std::string> counted = countedValue();
  if (!counted) return finish(false, notWritten(counted.error().message));
  const Result<fieldbus::Bytes> data =
      unnamed ? encodeObject(*unnamed, *counted) : encodeUnlisted(*counted, ticket_->data().size());
  if (!data) return finish(false, notWritten(data.error().message));
  const std::string moves = offsetRefusal(id_, *data);
  if (!moves.empty()) return finish(false, notWritten(moves));
  download(*data);
  return false;
}

bool ObjectJob::finish(bool success, std::string message) {
  if (locked_) axis_->endCalibration();
  locked_ = false;
  ObjectAnswer answer;
  answer.success = success;
  answer.message = std::move(message);
  give(reply_, answer);
  return true;
}

}  // namespace cia402::bus
