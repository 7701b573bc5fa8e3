"""Gives every camera of the active chunk the calibration of its own frame, and holds it.

Tools, Run Script, with the path of cameras.xml as argument; without one it is asked for. Cameras
are found by their labels; one that cameras.xml does not have keeps the sensor that it has.
"""

import sys
import xml.etree.ElementTree

import Metashape

TERMS = ("f", "cx", "cy", "b1", "b2", "k1", "k2", "k3", "k4", "p1", "p2")


def sensor_of(chunk, camera, frame):
    """Returns a new sensor like the camera's own, with the calibration of the frame."""
    size = frame.find("resolution")
    calibration = Metashape.Calibration()
    calibration.width = int(size.get("width"))
    calibration.height = int(size.get("height"))
    for term in TERMS:
        setattr(calibration, term, float(frame.findtext("calibration/" + term)))
    values = {one.get("name"): one.get("value") for one in frame.findall("property")}
    sensor = chunk.addSensor()
    sensor.label = frame.get("label")
    sensor.type = camera.sensor.type
    sensor.width, sensor.height = calibration.width, calibration.height
    sensor.pixel_width = float(values["pixel_width"])
    sensor.pixel_height = float(values["pixel_height"])
    sensor.focal_length = float(values["focal_length"])
    sensor.user_calib = calibration
    # The name before version 1.5 was `fixed`.
    setattr(sensor, "fixed_calibration" if hasattr(sensor, "fixed_calibration") else "fixed", True)
    return sensor


def main():
    file = sys.argv[1] if len(sys.argv) > 1 else Metashape.app.getOpenFileName("cameras.xml")
    tree = xml.etree.ElementTree.parse(file).getroot().find("chunk")
    sensors = {sensor.get("id"): sensor for sensor in tree.find("sensors")}
    frames = {one.get("label"): sensors[one.get("sensor_id")] for one in tree.find("cameras")}
    chunk = Metashape.app.document.chunk
    missing = []
    for camera in chunk.cameras:
        if camera.label in frames:
            camera.sensor = sensor_of(chunk, camera, frames.pop(camera.label))
        else:
            missing.append(camera.label)
    print("cameras without a frame:", ", ".join(missing) or "none")
    print("frames without a camera:", ", ".join(frames) or "none")


main()
