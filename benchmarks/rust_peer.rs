//! Encodes and decodes the messages of cpp_peer.cpp with the crate of ifgen, and prints the same lines: name, bytes, and
//! nanoseconds of CPU time to encode into a new vector, to encode into the same one again, and to
//! decode into a new message, and to decode into a view.
use std::hint::black_box;

use interfaces::cdr::{Message, View};
use interfaces::diagnostic_msgs::msg::{DiagnosticArray, DiagnosticArrayView, DiagnosticStatus, KeyValue};
use interfaces::geometry_msgs::msg::{Point, PoseStamped, PoseStampedView, Twist};
use interfaces::nav_msgs::msg::{Odometry, OdometryView, Path, PathView};
use interfaces::sensor_msgs::msg::{
    Image, ImageView, Imu, ImuView, JointState, JointStateView, LaserScan, LaserScanView, PointCloud2, PointCloud2View,
    PointField,
};
use interfaces::std_msgs::msg::{Header, String as Text, StringView as TextView};
use interfaces::visualization_msgs::msg::{Marker, MarkerView};

#[repr(C)]
struct Timespec {
    seconds: i64,
    nanoseconds: i64,
}
extern "C" {
    fn clock_gettime(clock: i32, time: *mut Timespec) -> i32;
}

/// Nanoseconds of CPU time of this process. std has no such clock.
fn now() -> f64 {
    let mut time = Timespec { seconds: 0, nanoseconds: 0 };
    unsafe { clock_gettime(2, &mut time) };
    time.seconds as f64 * 1e9 + time.nanoseconds as f64
}

fn nanoseconds(mut call: impl FnMut()) -> f64 {
    let mut round = |count: usize| {
        let start = now();
        (0..count).for_each(|_| call());
        now() - start
    };
    let mut count = 1;
    while round(count) < 5e6 {
        count *= 2;
    }
    let mut rounds: Vec<f64> = (0..7).map(|_| round(count) / count as f64).collect();
    rounds.sort_by(f64::total_cmp);
    rounds[3]
}

fn measure<M: Message>(name: &str, message: M, view: impl Fn(&[u8])) {
    let bytes = message.encode().unwrap();
    let mut again = Vec::new();
    let encode = nanoseconds(|| drop(black_box(black_box(&message).encode().unwrap())));
    let encode_again = nanoseconds(|| {
        black_box(&message).encode_into(&mut again).unwrap();
        black_box(&again);
    });
    let decode = nanoseconds(|| drop(black_box(M::decode(black_box(&bytes)).unwrap())));
    let borrowed = nanoseconds(|| view(black_box(&bytes)));
    println!("{name} {} {encode:.1} {encode_again:.1} {decode:.1} {borrowed:.1}", bytes.len());
}

/// Decodes into a view, or into a message that has nothing to borrow.
macro_rules! view {
    ($type:ty) => {
        |bytes| drop(black_box(<$type>::decode(bytes).unwrap()))
    };
}

fn main() {
    let mut header = Header::default();
    header.stamp.sec = 1700000000;
    header.stamp.nanosec = 123456789;
    header.frame_id = "base_link".into();
    let header = || header.clone();
    measure("String", Text { data: "hello world".into() }, view!(TextView));
    measure("Twist", Twist::default(), view!(Twist));
    let pose = PoseStamped { header: header(), ..Default::default() };
    measure("PoseStamped", pose.clone(), view!(PoseStampedView));
    measure("Imu", Imu { header: header(), ..Default::default() }, view!(ImuView));
    measure(
        "Odometry",
        Odometry { header: header(), child_frame_id: "odom".into(), ..Default::default() },
        view!(OdometryView),
    );
    let values = |step: f64| (0..30).map(|i| f64::from(i) * step).collect();
    measure(
        "JointState",
        JointState {
            header: header(),
            name: (0..30).map(|i| format!("joint_{}", 10 + i)).collect(),
            position: values(0.1),
            velocity: values(0.2),
            effort: values(0.3),
        },
        view!(JointStateView),
    );
    measure("Path", Path { header: header(), poses: vec![pose; 100] }, view!(PathView));
    let status = DiagnosticStatus {
        name: "motor driver".into(),
        message: "temperature is fine".into(),
        values: vec![KeyValue { key: "temperature".into(), value: "36.5".into() }; 10],
        ..Default::default()
    };
    measure(
        "DiagnosticArray",
        DiagnosticArray { header: header(), status: vec![status; 20] },
        view!(DiagnosticArrayView),
    );
    measure(
        "Marker",
        Marker { header: header(), points: vec![Point::default(); 1000], ..Default::default() },
        view!(MarkerView),
    );
    measure(
        "LaserScan",
        LaserScan { header: header(), ranges: vec![0.0; 1080], intensities: vec![0.0; 1080], ..Default::default() },
        view!(LaserScanView),
    );
    measure(
        "Image",
        Image { header: header(), encoding: "rgb8".into(), data: vec![0; 921600], ..Default::default() },
        view!(ImageView),
    );
    measure(
        "PointCloud2",
        PointCloud2 {
            header: header(),
            fields: vec![PointField::default(); 4],
            data: vec![0; 1600000],
            ..Default::default()
        },
        view!(PointCloud2View),
    );
}
