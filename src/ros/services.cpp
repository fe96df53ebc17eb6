// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "cia402_driver/ros/services.h"

#include <cia402_driver/ErrorHistory.h>
#include <cia402_driver/Nmt.h>
#include <cia402_driver/ReadObject.h>
#include <cia402_driver/SaveDcf.h>
#include <cia402_driver/SetMode.h>
#include <cia402_driver/SetPosition.h>
#include <cia402_driver/WriteObject.h>
#include <std_srvs/Trigger.h>

#include <memory>

#include "cia402_driver/drive/fault_text.h"
#include "cia402_driver/ros/command_call.h"
#include "cia402_driver/ros/dcf_file.h"

namespace cia402::ros_node {
namespace {

using drive::ProcedureKind;

/// The Trigger services, after interface.md.
constexpr struct {
  const char* name;
  ProcedureKind kind;
} kTriggers[] = {
    {"enable", ProcedureKind::enable},
    {"disable", ProcedureKind::disable},
    {"home", ProcedureKind::home},
    {"clear_faults", ProcedureKind::clear_faults},
    {"recover", ProcedureKind::recover},
    {"quick_stop", ProcedureKind::quick_stop},
    {"halt", ProcedureKind::halt},
    {"save_parameters", ProcedureKind::save_parameters},
    {"restore_parameters", ProcedureKind::restore_parameters},
};

std::string hexBytes(const fieldbus::Bytes& data) {
  static const char* const kDigits = "0123456789ABCDEF";
  std::string text;
  for (std::uint8_t byte : data) {
    if (!text.empty()) text += ' ';
    text += kDigits[byte >> 4];
    text += kDigits[byte & 0xF];
  }
  return text;
}

}  // namespace

Services::Services(ros::NodeHandle& private_node, CallDesk& desk, bus::BusRunner& runner,
                   const config::RobotConfig& robot)
    : desk_(desk), runner_(runner), robot_(robot) {
  advertise(private_node, "");
  advertiseDump(private_node);
  for (const drive::AxisConfig& axis : robot.axes) {
    ros::NodeHandle axis_node(private_node, axis.name);
    advertise(axis_node, axis.name);
    advertiseSaveDcf(axis_node, axis);
  }
}

void Services::advertiseTrigger(ros::NodeHandle& node, const char* name, const std::string& axis,
                                ProcedureKind kind) {
  servers_.push_back(desk_.advertise(node, name, [this, axis, kind](bus::Reply reply) {
    drive::ProcedureRequest request;
    request.kind = kind;
    bus::Command command;
    command.body = bus::ProcedureCommand{axis, request};
    command.reply = std::move(reply);
    runner_.post(std::move(command));
  }));
}

void Services::advertiseDump(ros::NodeHandle& node) {
  using Trigger = std_srvs::Trigger;
  servers_.push_back(node.advertiseService<Trigger::Request, Trigger::Response>(
      "dump_recording", [this](Trigger::Request&, Trigger::Response& response) {
        const bus::RecordingService::News news = runner_.recordings().request();
        response.success = news.written;
        response.message = news.text;
        return true;
      }));
}

void Services::advertiseHistory(ros::NodeHandle& node, const std::string& axis) {
  using History = cia402_driver::ErrorHistory;
  std::shared_ptr<const drive::DriveProfile> profile;
  for (const drive::AxisConfig& config : robot_.axes) {
    if (config.name == axis) profile = config.profile;
  }
  servers_.push_back(node.advertiseService<History::Request, History::Response>(
      "error_history", [this, axis, profile](History::Request&, History::Response& response) {
        const bus::Answer answer = call(runner_, bus::ErrorHistoryCommand{axis});
        respond(answer, response);
        for (const canopen::ErrorHistoryEntry& entry : answer.history.entries) {
          response.codes.push_back(entry.code);
          response.infos.push_back(entry.info);
          response.texts.push_back(drive::errorCodeText(*profile, entry.code));
        }
        return true;
      }));
}

// The drive is read in the bus thread; the file is planned, worded and written here.
void Services::advertiseSaveDcf(ros::NodeHandle& node, const drive::AxisConfig& axis) {
  using cia402_driver::SaveDcf;
  servers_.push_back(node.advertiseService<SaveDcf::Request, SaveDcf::Response>(
      "save_dcf", [this, &axis](SaveDcf::Request& request, SaveDcf::Response& response) {
        const auto stamp = dcfStamp(axis.name, request.path);
        if (!stamp) {
          response.message = stamp.error().message;
          return true;
        }
        bus::DcfDraft draft(axis, robot_.deviceOf(axis), *stamp);
        bus::Answer answer = call(runner_, draft.command());
        if (answer.success) answer = draft.finish();
        response.message = answer.message;
        if (!answer.success) return true;
        const auto written = writeDcfFile(request.path, answer.text);
        response.success = written.ok();
        response.message += written ? "; written to " + *written : "; " + written.error().message;
        return true;
      }));
}

void Services::advertise(ros::NodeHandle node, const std::string& axis) {
  for (const auto& trigger : kTriggers) advertiseTrigger(node, trigger.name, axis, trigger.kind);
  servers_.push_back(
      node.advertiseService<cia402_driver::SetMode::Request, cia402_driver::SetMode::Response>(
          "set_mode", [this, axis](cia402_driver::SetMode::Request& request,
                                   cia402_driver::SetMode::Response& response) {
            drive::ProcedureRequest wanted;
            wanted.kind = ProcedureKind::set_mode;
            wanted.mode = drive::canonicalModeName(request.mode);
            return respond(call(runner_, bus::ProcedureCommand{axis, wanted}), response);
          }));
  servers_.push_back(
      node.advertiseService<cia402_driver::Nmt::Request, cia402_driver::Nmt::Response>(
          "nmt", [this, axis](cia402_driver::Nmt::Request& request,
                              cia402_driver::Nmt::Response& response) {
            return respond(call(runner_, bus::NmtServiceCommand{axis, request.command}), response);
          }));
  if (axis.empty()) return;  // the rest makes sense for one axis only
  advertiseHistory(node, axis);
  servers_.push_back(node.advertiseService<cia402_driver::SetPosition::Request,
                                           cia402_driver::SetPosition::Response>(
      "set_position", [this, axis](cia402_driver::SetPosition::Request& request,
                                   cia402_driver::SetPosition::Response& response) {
        drive::ProcedureRequest wanted;
        wanted.kind = ProcedureKind::set_position;
        wanted.position = request.position;
        return respond(call(runner_, bus::ProcedureCommand{axis, wanted}), response);
      }));
  servers_.push_back(node.advertiseService<cia402_driver::ReadObject::Request,
                                           cia402_driver::ReadObject::Response>(
      "read_object", [this, axis](cia402_driver::ReadObject::Request& request,
                                  cia402_driver::ReadObject::Response& response) {
        const bus::Answer answer = call(runner_, bus::ReadObjectCommand{axis, request.object});
        respond(answer, response);
        response.value = answer.text;
        response.raw = hexBytes(answer.data);
        response.number = answer.number;
        response.bytes = answer.data;
        return true;
      }));
  servers_.push_back(node.advertiseService<cia402_driver::WriteObject::Request,
                                           cia402_driver::WriteObject::Response>(
      "write_object", [this, axis](cia402_driver::WriteObject::Request& request,
                                   cia402_driver::WriteObject::Response& response) {
        return respond(call(runner_, bus::WriteObjectCommand{axis, request.object, request.value}),
                       response);
      }));
}

}  // namespace cia402::ros_node
