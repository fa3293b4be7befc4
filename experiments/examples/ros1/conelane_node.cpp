// A node for ROS 1: cones in, the path to drive out.
//
// Takes `cones`, eufs_msgs/ConeArrayWithCovariance, in any frame that TF knows. Publishes in the map's frame,
// with the stamp of the cones:
// - `path`, nav_msgs/Path: empty where there is no path
// - `markers`, visualization_msgs/MarkerArray: both boundaries, dark as far as they are trusted
// - `/diagnostics`, diagnostic_msgs/DiagnosticArray: state of the plan, or what is wrong with the cones
//
// Private parameters: mission, detector, laps, map_frame, car_frame, time_limit_ms, transform_wait_s.

#include "experiments/examples/ros1/planner_face.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <stdexcept>

#include <diagnostic_msgs/DiagnosticArray.h>
#include <nav_msgs/Path.h>
#include <ros/ros.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>
#include <topic_tools/shape_shifter.h>
#include <visualization_msgs/MarkerArray.h>

namespace {

using conelane_ros1::PathPoint;
using conelane_ros1::Planar;
using conelane_ros1::SeenCone;
using Status = diagnostic_msgs::DiagnosticStatus;

/// Cones in the frame of their header.
struct Sighting {
    std_msgs::Header header;
    std::vector<SeenCone> cones;
};

/// Of eufs_msgs/ConeArrayWithCovariance as it is on the wire: that package need not be installed.
Sighting read(const topic_tools::ShapeShifter& message) {
    if (message.getDataType() != "eufs_msgs/ConeArrayWithCovariance")
        throw std::runtime_error("cones: of type " + message.getDataType() + " cannot be read");
    std::vector<std::uint8_t> bytes(message.size());
    ros::serialization::OStream out(bytes.data(), message.size());
    message.write(out);
    ros::serialization::IStream in(bytes.data(), message.size());
    Sighting sighting;
    in.next(sighting.header);
    for (int color = 0; color < 5; ++color) {
        std::uint32_t count = 0;
        in.next(count);
        for (std::uint32_t i = 0; i < count; ++i) {
            std::array<double, 7> values{};  // x, y, z and xx, xy, yx, yy
            for (double& value : values) in.next(value);
            const auto [x, y, z, xx, xy, yx, yy] = values;
            sighting.cones.push_back({x, y, color, xx, 0.5 * (xy + yx), yy});
        }
    }
    return sighting;
}

Planar planar(const geometry_msgs::Transform& from) {
    const auto& q = from.rotation;
    return {from.translation.x,
            from.translation.y,
            1.0 - 2.0 * (q.y * q.y + q.z * q.z),
            2.0 * (q.x * q.y - q.z * q.w),
            2.0 * (q.x * q.y + q.z * q.w),
            1.0 - 2.0 * (q.x * q.x + q.z * q.z)};
}

geometry_msgs::Point beside(const PathPoint& point, double left_m) {
    geometry_msgs::Point place;
    place.x = point.x_m - left_m * std::sin(point.heading_rad);
    place.y = point.y_m + left_m * std::cos(point.heading_rad);
    return place;
}

class Node {
  public:
    Node() { subscriber_ = node_.subscribe("cones", 1, &Node::answer, this); }

  private:
    void answer(const topic_tools::ShapeShifter::ConstPtr& message) {
        std_msgs::Header header;
        header.stamp = ros::Time::now();
        try {
            Sighting sighting = read(*message);
            header.stamp = sighting.header.stamp;
            plan(sighting, header);
        } catch (const std::exception& error) {  // of TF, of the message, of the frame
            report(header.stamp, Status::ERROR, error.what(), {});
        }
    }

    void plan(const Sighting& sighting, std_msgs::Header header) {
        header.frame_id = map_frame_;
        const Planar seen_from = transform(sighting.header.frame_id, header.stamp);
        const Planar car = transform(car_frame_, header.stamp);
        const conelane_ros1::Answer answer =
            planner_.update(header.stamp.toSec(), car, sighting.cones, seen_from, time_limit_ms_);
        publish(answer.path, header);
        const bool is_good = answer.state == "following" || answer.state == "finished";
        report(header.stamp,
               is_good                  ? Status::OK
               : answer.state == "lost" ? Status::ERROR
                                        : Status::WARN,
               answer.state, answer.values);
    }

    /// Throws tf2::TransformException.
    Planar transform(const std::string& frame, const ros::Time& stamp) const {
        return planar(buffer_.lookupTransform(map_frame_, frame, stamp, wait_).transform);
    }

    void publish(const std::vector<PathPoint>& points, const std_msgs::Header& header) const {
        nav_msgs::Path path;
        path.header = header;
        visualization_msgs::MarkerArray boundaries;
        for (const int side : {1, -1}) {
            for (const bool trusted : {true, false}) {
                visualization_msgs::Marker line;
                line.header = header;
                line.ns = side > 0 ? "left" : "right";
                line.id = trusted ? 0 : 1;
                line.type = visualization_msgs::Marker::LINE_STRIP;
                line.pose.orientation.w = 1.0;
                line.scale.x = 0.1;
                line.color.a = trusted ? 1.0F : 0.4F;
                (side > 0 ? line.color.b : line.color.r) = 1.0F;
                if (side < 0) line.color.g = 0.8F;
                for (const PathPoint& point : points) {
                    if (trusted != point.trusted) continue;
                    line.points.push_back(
                        beside(point, side > 0 ? point.width_left_m : -point.width_right_m));
                }
                if (line.points.size() < 2) line.action = visualization_msgs::Marker::DELETE;
                boundaries.markers.push_back(line);
            }
        }
        for (const PathPoint& point : points) {
            geometry_msgs::PoseStamped pose;
            pose.header = header;
            pose.pose.position = beside(point, 0.0);
            pose.pose.orientation.z = std::sin(0.5 * point.heading_rad);
            pose.pose.orientation.w = std::cos(0.5 * point.heading_rad);
            path.poses.push_back(pose);
        }
        path_.publish(path);
        markers_.publish(boundaries);
    }

    void report(const ros::Time& stamp, std::int8_t level, const std::string& message,
                const std::vector<std::pair<std::string, std::string>>& values) const {
        diagnostic_msgs::DiagnosticArray array;
        array.header.stamp = stamp;
        Status& status = array.status.emplace_back();
        status.level = level;
        status.name = ros::this_node::getName() + ": planner";
        status.message = message;
        for (const auto& [key, value] : values) {
            diagnostic_msgs::KeyValue& entry = status.values.emplace_back();
            entry.key = key;
            entry.value = value;
        }
        diagnostics_.publish(array);
    }

    ros::NodeHandle node_;
    ros::NodeHandle own_{"~"};
    std::string map_frame_ = own_.param<std::string>("map_frame", "map");
    std::string car_frame_ = own_.param<std::string>("car_frame", "base_link");
    double time_limit_ms_ = own_.param("time_limit_ms", 20.0);
    ros::Duration wait_{own_.param("transform_wait_s", 0.1)};
    conelane_ros1::PlannerFace planner_{own_.param<std::string>("mission", "trackdrive"),
                                        own_.param<std::string>("detector", "front-warm"),
                                        own_.param("laps", 0)};
    tf2_ros::Buffer buffer_;
    tf2_ros::TransformListener listener_{buffer_};
    ros::Publisher path_ = node_.advertise<nav_msgs::Path>("path", 1);
    ros::Publisher markers_ = node_.advertise<visualization_msgs::MarkerArray>("markers", 1);
    ros::Publisher diagnostics_ = node_.advertise<diagnostic_msgs::DiagnosticArray>("/diagnostics", 1);
    ros::Subscriber subscriber_;
};

}  // namespace

int main(int argument_count, char** arguments) {
    ros::init(argument_count, arguments, "conelane");
    try {
        const Node node;
        ros::spin();
    } catch (const std::exception& error) {
        ROS_FATAL_STREAM("conelane: " << error.what());
        return 2;
    }
    return 0;
}
