"""Where the numbers of several sensors come from."""

from __future__ import annotations

ALLSKY = "indi-allsky wiki, Camera Information (github.com/aaronwmorris/indi-allsky/wiki)"
LIBCAMERA = "libcamera, src/libcamera/sensor/camera_sensor_properties.cpp"
LUXONIS = "Luxonis hardware documentation (docs.luxonis.com/hardware/sensors)"
MATRIX_VISION = "matrix-vision.com mvBlueFOX3 manual"
RASPBERRY_PI = "Raspberry Pi documentation, camera modules (github.com/raspberrypi/documentation)"

CA_GT = "Balluff BVS CA-GT manual (assets.balluff.com/documents/DRF_957344_AA_000)"
CA_GX = "Balluff BVS CA-GX0 manual, sensor overview (assets.balluff.com/documents/DRF_957327_AA_000)"
CA_SF = "Balluff BVS CA-SF manual (assets.balluff.com/documents/DRF_957345_AA_000)"
CA_UB = "Balluff BVS CA-UB manual, sensor overview (assets.balluff.com/documents/DRF_958401_AA_000)"

# second hand, and said so: the copy names the documents it was made from
_COPIED = "copied in github.com/markvilar/brov-av-imaging-payload"
ALVIUM = f"Allied Vision Alvium CSI-2 user guide V4.2.0, {_COPIED}"


def alvium_emva(camera: str, says: str) -> str:
    """The data sheet of an Allied Vision camera, and what it says of electrons."""
    return f"Allied Vision Alvium 1800 {camera} data sheet, EMVA 1288: {says}; {_COPIED}"


def basler(camera: str) -> str:
    """The page of a Basler camera."""
    return f"Basler product documentation, {camera} (docs.baslerweb.com/{camera.lower()})"


def flir(camera: str) -> str:
    """The specifications of a Teledyne FLIR camera."""
    return (
        f"Teledyne FLIR {camera} specifications (softwareservices.flir.com/{camera}/latest/Model/spec.html)"
    )
