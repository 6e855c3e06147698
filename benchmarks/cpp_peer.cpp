// Encodes and decodes the same messages with the headers of ifgen, or, with -DROSIDL, with those of rosidl and Fast CDR.
// Prints a line for each: name, bytes, and nanoseconds of CPU time to encode into a new vector, to encode into the same
// one again, to decode into a new message, and into the same one again.
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <string>
#include <vector>

#include "diagnostic_msgs/msg/diagnostic_array.hpp"
#include "geometry_msgs/msg/pose_stamped.hpp"
#include "geometry_msgs/msg/twist.hpp"
#include "nav_msgs/msg/odometry.hpp"
#include "nav_msgs/msg/path.hpp"
#include "sensor_msgs/msg/image.hpp"
#include "sensor_msgs/msg/imu.hpp"
#include "sensor_msgs/msg/joint_state.hpp"
#include "sensor_msgs/msg/laser_scan.hpp"
#include "sensor_msgs/msg/point_cloud2.hpp"
#include "std_msgs/msg/string.hpp"
#include "visualization_msgs/msg/marker.hpp"

using Bytes = std::vector<std::uint8_t>;

#ifdef ROSIDL
#include "fastcdr/Cdr.h"
#include "fastcdr/FastBuffer.h"
#define TYPE(package, snake, Name) \
  namespace package::msg::typesupport_fastrtps_cpp { \
  bool cdr_serialize(const Name &, eprosima::fastcdr::Cdr &); \
  bool cdr_deserialize(eprosima::fastcdr::Cdr &, Name &); \
  size_t get_serialized_size(const Name &, size_t); } \
  inline bool put(const package::msg::Name & m, eprosima::fastcdr::Cdr & c) { \
    return package::msg::typesupport_fastrtps_cpp::cdr_serialize(m, c); } \
  inline bool get(eprosima::fastcdr::Cdr & c, package::msg::Name & m) { \
    return package::msg::typesupport_fastrtps_cpp::cdr_deserialize(c, m); } \
  inline size_t size(const package::msg::Name & m) { \
    return package::msg::typesupport_fastrtps_cpp::get_serialized_size(m, 0); }
TYPE(diagnostic_msgs, diagnostic_array, DiagnosticArray)
TYPE(geometry_msgs, pose_stamped, PoseStamped)
TYPE(geometry_msgs, twist, Twist)
TYPE(nav_msgs, odometry, Odometry)
TYPE(nav_msgs, path, Path)
TYPE(sensor_msgs, image, Image)
TYPE(sensor_msgs, imu, Imu)
TYPE(sensor_msgs, joint_state, JointState)
TYPE(sensor_msgs, laser_scan, LaserScan)
TYPE(sensor_msgs, point_cloud2, PointCloud2)
TYPE(std_msgs, string, String)
TYPE(visualization_msgs, marker, Marker)

template<class Message>
void write(const Message & message, Bytes & bytes)
{
  bytes.resize(size(message) + 4);
  eprosima::fastcdr::FastBuffer buffer(reinterpret_cast<char *>(bytes.data()), bytes.size());
  eprosima::fastcdr::Cdr cdr(
    buffer, eprosima::fastcdr::Cdr::DEFAULT_ENDIAN, eprosima::fastcdr::CdrVersion::XCDRv1);
  cdr.set_encoding_flag(eprosima::fastcdr::EncodingAlgorithmFlag::PLAIN_CDR);
  cdr.serialize_encapsulation();
  put(message, cdr);
  bytes.resize(cdr.get_serialized_data_length());
}

template<class Message>
void read(Bytes & bytes, Message & message)
{
  eprosima::fastcdr::FastBuffer buffer(reinterpret_cast<char *>(bytes.data()), bytes.size());
  eprosima::fastcdr::Cdr cdr(
    buffer, eprosima::fastcdr::Cdr::DEFAULT_ENDIAN, eprosima::fastcdr::CdrVersion::XCDRv1);
  cdr.read_encapsulation();
  get(cdr, message);
}
#else
template<class Message>
void write(const Message & message, Bytes & bytes) {static_cast<void>(ifgen::encode(message, bytes));}

template<class Message>
void read(Bytes & bytes, Message & message) {static_cast<void>(ifgen::decode(bytes, message));}
#endif

double now()
{
  timespec time;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return double(time.tv_sec) * 1e9 + double(time.tv_nsec);
}

template<class Call>
double nanoseconds(Call call)
{
  std::size_t count = 1;
  for (double time = 0; time < 5e6; count *= 2) {
    const double start = now();
    for (std::size_t i = 0; i < count; ++i) {call();}
    time = now() - start;
  }
  std::vector<double> rounds;
  for (int i = 0; i < 7; ++i) {
    const double start = now();
    for (std::size_t k = 0; k < count; ++k) {call();}
    rounds.push_back((now() - start) / double(count));
  }
  std::sort(rounds.begin(), rounds.end());
  return rounds[rounds.size() / 2];
}

template<class Thing>
void use(Thing & thing) {asm volatile ("" : : "r"(&thing) : "memory");}

template<class Message>
void measure(const char * name, const Message & message)
{
  Bytes bytes, again;
  write(message, bytes);
  Message old;
  read(bytes, old);
  write(old, again);
  const double encode = nanoseconds([&] {Bytes fresh; write(message, fresh); use(fresh);});
  const double encode_again = nanoseconds([&] {write(message, again); use(again);});
  const double decode = nanoseconds([&] {Message fresh; read(bytes, fresh); use(fresh);});
  const double decode_again = nanoseconds([&] {read(bytes, old); use(old);});
  std::printf("%s %zu %.1f %.1f %.1f %.1f\n", name, bytes.size(), encode, encode_again, decode, decode_again);
}

int main()
{
  std_msgs::msg::Header header;
  header.stamp.sec = 1700000000;
  header.stamp.nanosec = 123456789;
  header.frame_id = "base_link";
  {
    std_msgs::msg::String m;
    m.data = "hello world";
    measure("String", m);
  }
  measure("Twist", geometry_msgs::msg::Twist());
  geometry_msgs::msg::PoseStamped pose;
  pose.header = header;
  measure("PoseStamped", pose);
  {
    sensor_msgs::msg::Imu m;
    m.header = header;
    measure("Imu", m);
  }
  {
    nav_msgs::msg::Odometry m;
    m.header = header;
    m.child_frame_id = "odom";
    measure("Odometry", m);
  }
  {
    sensor_msgs::msg::JointState m;
    m.header = header;
    for (int i = 0; i < 30; ++i) {
      m.name.push_back("joint_" + std::to_string(10 + i));
      m.position.push_back(i * 0.1);
      m.velocity.push_back(i * 0.2);
      m.effort.push_back(i * 0.3);
    }
    measure("JointState", m);
  }
  {
    nav_msgs::msg::Path m;
    m.header = header;
    m.poses.assign(100, pose);
    measure("Path", m);
  }
  {
    diagnostic_msgs::msg::DiagnosticArray m;
    m.header = header;
    m.status.resize(20);
    for (auto & status : m.status) {
      status.name = "motor driver";
      status.message = "temperature is fine";
      status.values.resize(10);
      for (auto & value : status.values) {value.key = "temperature"; value.value = "36.5";}
    }
    measure("DiagnosticArray", m);
  }
  {
    visualization_msgs::msg::Marker m;
    m.header = header;
    m.points.resize(1000);
    measure("Marker", m);
  }
  {
    sensor_msgs::msg::LaserScan m;
    m.header = header;
    m.ranges.resize(1080);
    m.intensities.resize(1080);
    measure("LaserScan", m);
  }
  {
    sensor_msgs::msg::Image m;
    m.header = header;
    m.encoding = "rgb8";
    m.data.resize(921600);
    measure("Image", m);
  }
  {
    sensor_msgs::msg::PointCloud2 m;
    m.header = header;
    m.fields.resize(4);
    m.data.resize(1600000);
    measure("PointCloud2", m);
  }
}
