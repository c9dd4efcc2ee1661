// Definitions of the usual packages, for recordings that name types and do not define them (SQLite bags before 2023).
// Facts of the packages' own .msg files: common_interfaces, mavros_msgs, tf2_msgs.
#include <array>
#include <set>
#include <string_view>
#include <utility>

#include "common/recordings/ros/definition.hpp"
#include "common/recordings/ros/raw_definition.hpp"

namespace fathom::recordings::ros {
namespace {

struct Usual {
  std::string_view name, members;
};

constexpr std::array kUsual{
    Usual{"builtin_interfaces/Time", "int32 sec\nuint32 nanosec"},
    Usual{"builtin_interfaces/Duration", "int32 sec\nuint32 nanosec"},
    Usual{"std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id"},
    Usual{"std_msgs/Bool", "bool data"},
    Usual{"std_msgs/Byte", "byte data"},
    Usual{"std_msgs/Char", "char data"},
    Usual{"std_msgs/Int8", "int8 data"},
    Usual{"std_msgs/Int16", "int16 data"},
    Usual{"std_msgs/Int32", "int32 data"},
    Usual{"std_msgs/Int64", "int64 data"},
    Usual{"std_msgs/UInt8", "uint8 data"},
    Usual{"std_msgs/UInt16", "uint16 data"},
    Usual{"std_msgs/UInt32", "uint32 data"},
    Usual{"std_msgs/UInt64", "uint64 data"},
    Usual{"std_msgs/Float32", "float32 data"},
    Usual{"std_msgs/Float64", "float64 data"},
    Usual{"std_msgs/String", "string data"},
    Usual{"std_msgs/Empty", ""},
    Usual{"std_msgs/MultiArrayDimension", "string label\nuint32 size\nuint32 stride"},
    Usual{"std_msgs/MultiArrayLayout", "MultiArrayDimension[] dim\nuint32 data_offset"},
    Usual{"std_msgs/Float32MultiArray", "MultiArrayLayout layout\nfloat32[] data"},
    Usual{"std_msgs/Float64MultiArray", "MultiArrayLayout layout\nfloat64[] data"},
    Usual{"std_msgs/Int16MultiArray", "MultiArrayLayout layout\nint16[] data"},
    Usual{"std_msgs/Int32MultiArray", "MultiArrayLayout layout\nint32[] data"},
    Usual{"std_msgs/UInt16MultiArray", "MultiArrayLayout layout\nuint16[] data"},
    Usual{"geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z"},
    Usual{"geometry_msgs/Vector3Stamped", "std_msgs/Header header\nVector3 vector"},
    Usual{"geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z"},
    Usual{"geometry_msgs/PointStamped", "std_msgs/Header header\nPoint point"},
    Usual{"geometry_msgs/Quaternion", "float64 x\nfloat64 y\nfloat64 z\nfloat64 w"},
    Usual{"geometry_msgs/QuaternionStamped", "std_msgs/Header header\nQuaternion quaternion"},
    Usual{"geometry_msgs/Pose", "Point position\nQuaternion orientation"},
    Usual{"geometry_msgs/PoseStamped", "std_msgs/Header header\nPose pose"},
    Usual{"geometry_msgs/PoseWithCovariance", "Pose pose\nfloat64[36] covariance"},
    Usual{"geometry_msgs/PoseWithCovarianceStamped", "std_msgs/Header header\nPoseWithCovariance pose"},
    Usual{"geometry_msgs/PoseArray", "std_msgs/Header header\nPose[] poses"},
    Usual{"geometry_msgs/Twist", "Vector3 linear\nVector3 angular"},
    Usual{"geometry_msgs/TwistStamped", "std_msgs/Header header\nTwist twist"},
    Usual{"geometry_msgs/TwistWithCovariance", "Twist twist\nfloat64[36] covariance"},
    Usual{"geometry_msgs/TwistWithCovarianceStamped", "std_msgs/Header header\nTwistWithCovariance twist"},
    Usual{"geometry_msgs/Accel", "Vector3 linear\nVector3 angular"},
    Usual{"geometry_msgs/AccelStamped", "std_msgs/Header header\nAccel accel"},
    Usual{"geometry_msgs/Wrench", "Vector3 force\nVector3 torque"},
    Usual{"geometry_msgs/WrenchStamped", "std_msgs/Header header\nWrench wrench"},
    Usual{"geometry_msgs/Transform", "Vector3 translation\nQuaternion rotation"},
    Usual{"geometry_msgs/TransformStamped", "std_msgs/Header header\nstring child_frame_id\nTransform transform"},
    Usual{"nav_msgs/Odometry",
          "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose\n"
          "geometry_msgs/TwistWithCovariance twist"},
    Usual{"nav_msgs/Path", "std_msgs/Header header\ngeometry_msgs/PoseStamped[] poses"},
    Usual{"sensor_msgs/Imu",
          "std_msgs/Header header\ngeometry_msgs/Quaternion orientation\nfloat64[9] orientation_covariance\n"
          "geometry_msgs/Vector3 angular_velocity\nfloat64[9] angular_velocity_covariance\n"
          "geometry_msgs/Vector3 linear_acceleration\nfloat64[9] linear_acceleration_covariance"},
    Usual{"sensor_msgs/MagneticField",
          "std_msgs/Header header\ngeometry_msgs/Vector3 magnetic_field\nfloat64[9] magnetic_field_covariance"},
    Usual{"sensor_msgs/FluidPressure", "std_msgs/Header header\nfloat64 fluid_pressure\nfloat64 variance"},
    Usual{"sensor_msgs/Temperature", "std_msgs/Header header\nfloat64 temperature\nfloat64 variance"},
    Usual{"sensor_msgs/Range",
          "std_msgs/Header header\nuint8 radiation_type\nfloat32 field_of_view\nfloat32 min_range\nfloat32 max_range\n"
          "float32 range"},
    Usual{"sensor_msgs/JointState",
          "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort"},
    Usual{"sensor_msgs/Joy", "std_msgs/Header header\nfloat32[] axes\nint32[] buttons"},
    Usual{"sensor_msgs/NavSatStatus", "int8 status\nuint16 service"},
    Usual{"sensor_msgs/NavSatFix",
          "std_msgs/Header header\nNavSatStatus status\nfloat64 latitude\nfloat64 longitude\nfloat64 altitude\n"
          "float64[9] position_covariance\nuint8 position_covariance_type"},
    Usual{"sensor_msgs/BatteryState",
          "std_msgs/Header header\nfloat32 voltage\nfloat32 temperature\nfloat32 current\nfloat32 charge\n"
          "float32 capacity\nfloat32 design_capacity\nfloat32 percentage\nuint8 power_supply_status\n"
          "uint8 power_supply_health\nuint8 power_supply_technology\nbool present\nfloat32[] cell_voltage\n"
          "float32[] cell_temperature\nstring location\nstring serial_number"},
    Usual{"tf2_msgs/TFMessage", "geometry_msgs/TransformStamped[] transforms"},
    Usual{"mavros_msgs/RCOut", "std_msgs/Header header\nuint16[] channels"},
    Usual{"mavros_msgs/RCIn", "std_msgs/Header header\nuint8 rssi\nuint16[] channels"},
    Usual{"mavros_msgs/OverrideRCIn", "uint16[18] channels"},
    Usual{"mavros_msgs/VfrHud",
          "std_msgs/Header header\nfloat32 airspeed\nfloat32 groundspeed\nint16 heading\nfloat32 throttle\n"
          "float32 altitude\nfloat32 climb"},
    Usual{"mavros_msgs/ManualControl",
          "std_msgs/Header header\nfloat32 x\nfloat32 y\nfloat32 z\nfloat32 r\nuint16 buttons"},
};

const Usual* usual(const std::string& name) {
  for (const Usual& each : kUsual) {
    if (each.name == name) return &each;
  }
  return nullptr;
}

void gather(const std::string& name, std::set<std::string>& told, std::string& text) {
  const Usual* own = usual(name);
  if (own == nullptr || !told.insert(name).second) return;
  if (!text.empty())
    text += "\n================================================================================\nMSG: " + name + "\n";
  text += std::string{own->members} + "\n";
  for (const auto& [type, members] : raw_from_msg(name, own->members)) {
    for (const RawMember& member : members) {
      const bool other = member.type.find('/') != std::string::npos;
      gather(other ? member.type : name.substr(0, name.find('/') + 1) + member.type, told, text);
    }
  }
}

}  // namespace

std::string usual_definition(const std::string& name) {
  std::set<std::string> told;
  std::string text;
  gather(short_name(name), told, text);
  return text;
}

}  // namespace fathom::recordings::ros
