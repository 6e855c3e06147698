/* Reads a sensor that is not there, and publishes what it measured: one payload a line, in hexadecimal. */
#include <string.h>

#include "board.h"
#include "sensor_msgs/msg/imu.h"
#include "sensor_msgs/msg/joint_state.h"

static uint8_t bytes[sensor_msgs__msg__JointState_MAX_SIZE];
static sensor_msgs__msg__Imu imu;
static sensor_msgs__msg__JointState joints;

static void publish(const char *topic, size_t size)
{
  char digits[3] = {0};
  size_t i;
  print(topic);
  print(" ");
  for (i = 0; i < size; ++i) {
    digits[0] = "0123456789abcdef"[bytes[i] >> 4];
    digits[1] = "0123456789abcdef"[bytes[i] & 15];
    print(digits);
  }
  print("\n");
}

int main(void)
{
  uint32_t i;
  sensor_msgs__msg__Imu_init(&imu);
  sensor_msgs__msg__JointState_init(&joints);
  strcpy(imu.header.frame_id, "imu_link");
  imu.orientation.w = 1.0;
  joints.name.size = joints.position.size = 2;
  strcpy(joints.name.data[0], "left");
  strcpy(joints.name.data[1], "right");
  for (i = 0; i < 3; ++i) {
    size_t size;
    imu.header.stamp.sec = (int32_t)i;
    imu.linear_acceleration.z = 9.5 + i;
    joints.header.stamp = imu.header.stamp;
    joints.position.data[1] = 0.25 * i;
    size = sensor_msgs__msg__Imu_encode(&imu, bytes, sizeof bytes);
    /* What it wrote, it can read. */
    if (size == 0 || !sensor_msgs__msg__Imu_decode(&imu, bytes, size)) {
      return 1;
    }
    publish("imu", size);
    size = sensor_msgs__msg__JointState_encode(&joints, bytes, sizeof bytes);
    if (size == 0 || !sensor_msgs__msg__JointState_decode(&joints, bytes, size)) {
      return 1;
    }
    publish("joint_states", size);
  }
  return 0;
}
