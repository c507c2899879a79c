"""Small files of every form that are right, to be made wrong; the name says the form."""

from __future__ import annotations

_MATRIX = """!!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 800., 0., 320., 0., 800., 240., 0., 0., 1. ]"""
_FRAME = "[0,-1,0,0],[0,0,-1,0],[0,0,0,1]]"

_TEXTS = {
    "rig.toml": """baseline_mm = 120.0
width_px = 1280
height_px = 720
focal_px = 900.0
vergence_deg = 2.0
[sensor]
name = "IMX477"
blur_px = 0.6
""",
    "stereo.yml": f"""%YAML:1.0
---
image_width: 640
image_height: 480
K1: {_MATRIX}
K2: {_MATRIX}
R: [[1,0,0],[0,1,0],[0,0,1]]
T: [-0.12, 0, 0]
""",
    "camchain.yaml": """cam0:
  camera_model: pinhole
  intrinsics: [458., 457., 367., 248.]
  distortion_model: radtan
  distortion_coeffs: [-0.28, 0.07, 0.0002, 1.7e-05]
  resolution: [752, 480]
cam1:
  T_cn_cnm1:
  - [1, 0, 0, -0.11]
  - [0, 1, 0, 0]
  - [0, 0, 1, 0]
  - [0, 0, 0, 1]
  camera_model: pinhole
  intrinsics: [457., 456., 380., 255.]
  distortion_model: none
  distortion_coeffs: []
  resolution: [752, 480]
""",
    "calib.txt": """cam0=[800 0 320; 0 800 240; 0 0 1]
cam1=[800 0 331; 0 800 240; 0 0 1]
doffs=11
baseline=120
width=640
height=480
ndisp=64
""",
    "transforms.json": f"""{{"camera_model": "OPENCV", "w": 640, "h": 480, "fl_x": 800, "fl_y": 800,
 "cx": 320, "cy": 240, "frames": [
 {{"file_path": "left.png", "transform_matrix": [[1,0,0,0],{_FRAME}}},
 {{"file_path": "right.png", "transform_matrix": [[1,0,0,0.1],{_FRAME}}}]}}
""",
    "rig.xml": """<mujoco><worldbody><body name="rigsim_rig">
<camera name="rigsim_left" resolution="640 480" sensorsize="640 480" focalpixel="800 800"
 principalpixel="0 0" pos="-0.06 0 0"/>
<camera name="rigsim_right" resolution="640 480" sensorsize="640 480" focalpixel="800 800"
 principalpixel="0 0" pos="0.06 0 0"/>
</body></worldbody></mujoco>
""",
    "errors.csv": """distance_mm,depth_std_mm,depth_bias_mm,n
1000,2.1,0.1,50
2000,8.4,0.4,50
3000,19.1,1,50
4000,34,2,50
""",
    "scene.mjcf.xml": """<mujoco><visual><global fovy="50"/></visual>
<asset><texture name="t" type="2d" builtin="checker" width="32" height="32" rgb1="1 1 1" rgb2="0 0 0"/>
<material name="m" texture="t"/></asset>
<worldbody><light pos="0 0 3"/><geom name="floor" type="plane" size="3 3 .1" material="m"/>
<body name="box" pos="2 0 .5"><geom type="box" size=".3 .3 .5"/></body>
<body name="head" pos="0 0 1"><camera name="eye" xyaxes="0 -1 0 0 0 1"/></body></worldbody></mujoco>
""",
}

SEEDS = {name: text.encode() for name, text in _TEXTS.items()}
