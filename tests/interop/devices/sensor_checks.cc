// SPDX-License-Identifier: MIT
#include <yarp/conf/version.h>
#include <yarp/dev/IFrameGrabberImage.h>
#include <yarp/dev/IOdometry2D.h>
#include <yarp/dev/IRangefinder2D.h>
#include <yarp/dev/IRgbVisualParams.h>
#include <yarp/dev/MultipleAnalogSensorsInterfaces.h>
#include <yarp/dev/PolyDriver.h>
#include <yarp/os/BufferedPort.h>
#include <yarp/os/Network.h>
#include <yarp/os/Property.h>
#include <yarp/sig/Image.h>
#include <yarp/sig/Vector.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "sections.h"

namespace coopdyn {
namespace {

#if __has_include(<yarp/dev/Odometry.h>)  // YARP 4 after 4.0.0
using Odometry = yarp::dev::Nav2D::Odometry;
#else
using Odometry = yarp::dev::OdometryData;
#endif

bool Open(yarp::dev::PolyDriver& driver, const std::string& device, const std::string& remote) {
  yarp::os::Property options;
  options.put("device", device);
  options.put("remote", remote);
  options.put("local", "/devices" + remote);
  options.put("timeout", 0.5);  // for a busy machine
  return driver.open(options);
}

std::vector<double> Values(const yarp::sig::Vector& vector) {
  return {vector.begin(), vector.end()};
}

std::array<double, 3> Three(const yarp::sig::Vector& vector) {
  if (vector.size() != 3) return {NAN, NAN, NAN};
  return {vector[0], vector[1], vector[2]};
}

/// Checks that the reading's time is within the run.
void CheckStamp(Checks& checks, const std::string& name, double stamp_s) {
  const double now_s = SimulatedTime();
  checks.That(name, stamp_s > now_s - 1 && stamp_s <= now_s, Text(stamp_s) + " at " + Text(now_s));
}

/// Drives the turtle like baseControl.
class Drive {
 public:
  bool Open() {
    return port_.open("/devices/base:o") &&
           yarp::os::Network::connect("/devices/base:o", "/turtle/base/command:i");
  }
  void Go(double forward_m_s, double turn_deg_s) {
    yarp::os::Bottle& command = port_.prepare();
    command.clear();
    command.addInt32(3);
    for (const double value : {forward_m_s, 0.0, turn_deg_s, 100.0}) command.addFloat64(value);
    port_.write(true);
  }

 private:
  yarp::os::BufferedPort<yarp::os::Bottle> port_;
};

class Imu {
 public:
  bool Open() {
    return coopdyn::Open(driver_, "multipleanalogsensorsclient", "/turtle/imu") &&
           driver_.view(gyroscopes_) && driver_.view(accelerometers_) && driver_.view(orientations_) &&
           WaitFor([this] { return gyroscopes_->getThreeAxisGyroscopeStatus(0) == yarp::dev::MAS_OK; });
  }
  std::array<double, 3> TurnRates() {
    yarp::sig::Vector values;
    gyroscopes_->getThreeAxisGyroscopeMeasure(0, values, stamp_s_);
    return Three(values);
  }
  double stamp_s() const { return stamp_s_; }

  void CheckAtRest(Checks& checks) {
    std::string name;
    checks.That("IMU: name", bool(gyroscopes_->getThreeAxisGyroscopeName(0, name)) && name == "imu", name);
    checks.AllNear("IMU: at rest it does not turn", TurnRates(), std::array{0.0, 0.0, 0.0}, 2);
    CheckStamp(checks, "IMU: stamp", stamp_s_);
    yarp::sig::Vector values;
    double stamp_s = NAN;
    accelerometers_->getThreeAxisLinearAccelerometerMeasure(0, values, stamp_s);
    checks.AllNear("IMU: it stands on the floor", Three(values), std::array{0.0, 0.0, 9.81}, 0.3);
    orientations_->getOrientationSensorMeasureAsRollPitchYaw(0, values, stamp_s);
    checks.AllNear("IMU: it looks ahead", Three(values), std::array{0.0, 0.0, 0.0}, 2);
  }

 private:
  yarp::dev::PolyDriver driver_;
  yarp::dev::IThreeAxisGyroscopes* gyroscopes_ = nullptr;
  yarp::dev::IThreeAxisLinearAccelerometers* accelerometers_ = nullptr;
  yarp::dev::IOrientationSensors* orientations_ = nullptr;
  double stamp_s_ = NAN;
};

void CheckWrench(Checks& checks) {
  yarp::dev::PolyDriver driver;
  yarp::dev::ISixAxisForceTorqueSensors* wrench = nullptr;
  const bool open = Open(driver, "multipleanalogsensorsclient", "/lwa/wrench") && driver.view(wrench);
  if (!checks.That("wrench: open", open)) return;
  yarp::sig::Vector values;
  double stamp_s = NAN;
  WaitFor([&] {
    return bool(wrench->getSixAxisForceTorqueSensorMeasure(0, values, stamp_s)) && values.size() == 6;
  });
  // The arm stands upright, and holds a flange of 300 g.
  checks.AllNear("wrench: the flange's weight", Values(values), std::array{0.0, 0.0, 2.94, 0.0, 0.0, 0.0},
                 0.4);
  CheckStamp(checks, "wrench: stamp", stamp_s);
  yarp::dev::IThreeAxisMagnetometers* magnetometers = nullptr;
  checks.That(
      "wrench: it has no magnetometer",
      driver.view(magnetometers) && !magnetometers->getThreeAxisMagnetometerMeasure(0, values, stamp_s),
      Text(Values(values)));
}

void CheckLidar(Checks& checks) {
  yarp::dev::PolyDriver driver;
  yarp::dev::IRangefinder2D* lidar = nullptr;
  if (!checks.That("lidar: open",
                   Open(driver, "rangefinder2D_nwc_yarp", "/turtle/lidar") && driver.view(lidar)))
    return;
  double from = NAN, to = NAN, step = NAN, stamp_s = NAN;
  lidar->getDistanceRange(from, to);
  checks.AllNear("lidar: range", std::array{from, to}, std::array{0.12, 3.5}, 1e-6);
  from = to = NAN;
  lidar->getScanLimits(from, to);
  checks.Near("lidar: all round", to - from, 360, 1e-6);
  lidar->getHorizontalResolution(step);
  checks.Near("lidar: resolution", step, 1, 1e-6);
  std::string what;
  checks.That("lidar: what it is", bool(lidar->getDeviceInfo(what)) && !what.empty());
  std::vector<yarp::sig::LaserMeasurementData> points;
  WaitFor([&] { return bool(lidar->getLaserMeasurement(points, &stamp_s)) && points.size() == 360; });
  checks.Near("lidar: rays", static_cast<double>(points.size()), 360, 0);
  CheckStamp(checks, "lidar: stamp", stamp_s);
  yarp::dev::IRangefinder2D::Device_status status{};
  checks.That("lidar: in use",
              bool(lidar->getDeviceStatus(status)) && status == yarp::dev::IRangefinder2D::DEVICE_OK_IN_USE);
  double ahead = NAN;
  for (yarp::sig::LaserMeasurementData& point : points) {
    double x = NAN, y = NAN;
    point.get_cartesian(x, y);
    if (x > 0 && std::abs(y) < 0.01) ahead = x;
  }
  checks.Near("lidar: the box ahead", ahead, 0.8, 0.06);
  checks.That("lidar: its range cannot be set", !lidar->setDistanceRange(0.1, 1), "taken");
}

void CheckCamera(Checks& checks) {
  yarp::dev::PolyDriver driver;
  yarp::dev::IFrameGrabberImage* grabber = nullptr;
  yarp::dev::IRgbVisualParams* lens = nullptr;
  const bool open =
      Open(driver, "frameGrabber_nwc_yarp", "/turtle/camera") && driver.view(grabber) && driver.view(lens);
  if (!checks.That("camera: open", open)) return;
  int width = 0, height = 0;
  lens->getRgbResolution(width, height);
  checks.That("camera: resolution", width == 320 && height == 240,
              std::to_string(width) + " x " + std::to_string(height));
  checks.Near("camera: width", lens->getRgbWidth(), 320, 0);
  double across = NAN, down = NAN;
  lens->getRgbFOV(across, down);
  checks.Near("camera: field of view", across, 58, 0.1);
#if YARP_VERSION_MAJOR >= 4
  std::vector<yarp::dev::CameraConfig> pictures;
#else
  yarp::sig::VectorOf<yarp::dev::CameraConfig> pictures;
#endif
  checks.That("camera: what pictures it has", bool(lens->getRgbSupportedConfigurations(pictures)) &&
                                                  pictures.size() == 1 && pictures[0].width == 320 &&
                                                  pictures[0].height == 240);
  yarp::os::Property parameters;
  checks.That("camera: parameters",
              bool(lens->getRgbIntrinsicParam(parameters)) && parameters.check("focalLengthX"),
              parameters.toString());
  // The clients crash if asked before their first picture has arrived; another reader detects its arrival.
  yarp::os::BufferedPort<yarp::sig::FlexImage> reader;
  checks.That("camera: a port of pictures",
              reader.open("/devices/picture:i") &&
                  yarp::os::Network::connect("/turtle/camera", "/devices/picture:i") &&
                  WaitFor([&] { return reader.getPendingReads() > 0; }));
  reader.close();
  Sleep(1);
  yarp::sig::ImageOf<yarp::sig::PixelRgb> image;
  checks.That("camera: picture", WaitFor([&] { return bool(grabber->getImage(image)) && image.width() > 0; }),
              "none in 10 s");
  if (!checks.That("camera: its size", image.width() == 320 && image.height() == 240)) return;
  const yarp::sig::PixelRgb& middle = image.pixel(160, 130);
  checks.That("camera: the red box ahead", middle.r > 2 * middle.g && middle.r > 2 * middle.b,
              std::to_string(middle.r) + " " + std::to_string(middle.g) + " " + std::to_string(middle.b));
}

/// A port with the type of its data: YARP registers it differently.
void CheckVectors(Checks& checks) {
  yarp::os::BufferedPort<yarp::sig::Vector> reader;
  const bool open =
      reader.open("/devices/pose:i") && yarp::os::Network::connect("/turtle/pose/state:o", "/devices/pose:i");
  if (!checks.That("pose: a port of vectors", open)) return;
  WaitFor([&] { return reader.getPendingReads() > 0; });
  const yarp::sig::Vector* const pose = reader.read(false);
  checks.AllNear("pose: it stands still", pose == nullptr ? std::vector<double>() : Values(*pose),
                 std::array{0.0, 0.0, 0.0, 0.0, 0.0}, 0.05);
}

void CheckDrive(Checks& checks, Imu& imu) {
  yarp::dev::PolyDriver driver;
  yarp::dev::Nav2D::IOdometry2D* odometry = nullptr;
  if (!checks.That("odometry: open",
                   Open(driver, "odometry2D_nwc_yarp", "/turtle/odometry") && driver.view(odometry)))
    return;
  Odometry first, now;
  double stamp_s = NAN;
  WaitFor([&] { return bool(odometry->getOdometry(first, &stamp_s)) && stamp_s > 0; });
  CheckStamp(checks, "odometry: stamp", stamp_s);
  Drive drive;
  if (!checks.That("drive: open", drive.Open())) return;
  drive.Go(0.1, 30);
  checks.That("odometry: speed and turn rate", WaitFor([&] {
                odometry->getOdometry(now, &stamp_s);
                return std::abs(now.base_vel_x - 0.1) < 0.02 && std::abs(now.base_vel_theta - 30) < 4;
              }),
              Text(now.base_vel_x) + " " + Text(now.base_vel_theta));
  checks.That("IMU: it turns", WaitFor([&] { return std::abs(imu.TurnRates()[2] - 30) < 3; }),
              Text(imu.TurnRates()));
  checks.That("odometry: heading", WaitFor([&] {
                odometry->getOdometry(now, &stamp_s);
                return now.odom_theta > first.odom_theta + 40;
              }),
              Text(now.odom_theta));
  drive.Go(0, 0);
  checks.That("drive: it stops", WaitFor([&] {
                odometry->getOdometry(now, &stamp_s);
                return std::abs(now.base_vel_x) < 0.01 && std::abs(now.base_vel_theta) < 1;
              }),
              Text(now.base_vel_x) + " " + Text(now.base_vel_theta));
  // An arc: its chord's direction is half its angle.
  checks.Near("odometry: place", std::atan2(now.odom_y - first.odom_y, now.odom_x - first.odom_x),
              (now.odom_theta + first.odom_theta) / 2 * M_PI / 180, 0.1);
  checks.That("odometry: no reset", !odometry->resetOdometry(), "taken");
}

}  // namespace

void CheckSensors(Checks& checks) {
  AskSimulation("reset");  // the turtle stands before the box
  Imu imu;
  if (checks.That("IMU: open", imu.Open())) imu.CheckAtRest(checks);
  CheckVectors(checks);
  CheckWrench(checks);
  CheckLidar(checks);
  CheckCamera(checks);
  CheckDrive(checks, imu);
}

}  // namespace coopdyn
