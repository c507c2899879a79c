"""What is published of commercial stereo cameras: every figure with its source, contradictions included.

The first figure of a quantity is the one the preset's rig is made of; others of the same quantity
contradict it or hold in another mode. What no stored page could be found for is left out.
"""

from __future__ import annotations

from dataclasses import dataclass

_HEARSAY = "unconfirmed user report: "


@dataclass(frozen=True, slots=True)
class Figure:
    """One published number."""

    quantity: str
    """What it is, unit in the name: ``baseline_mm``, ``hfov_deg``, ``accuracy_pct``."""
    value: float
    """The number."""
    source: str
    """Page and address."""
    note: str = ""
    """In which mode, or what is odd about it."""
    at_mm: float | None = None
    """Distance an accuracy is claimed for, mm."""

    @property
    def hearsay(self) -> bool:
        """Whether it rests on what a user quotes or lists, and on nothing else."""
        return self.source.startswith(_HEARSAY)


@dataclass(frozen=True, slots=True)
class CommercialCamera:
    """A stereo camera on the market."""

    name: str
    """Name on the command line."""
    about: str
    """Maker and model."""
    figures: tuple[Figure, ...]
    """All that is published."""


def first(figures: tuple[Figure, ...], quantity: str) -> float | None:
    """The figure of `quantity` that counts; None where none was found."""
    return next((item.value for item in figures if item.quantity == quantity), None)


_OAK_FAQ = "Luxonis, Stereo Depth FAQ (docs.luxonis.com/software-v3/support/faq/stereo-depth)"
_OAK_D = "Luxonis, OAK-D product page (docs.luxonis.com/hardware/products/OAK-D)"
_OAK_SHEET = "OAK-D Spec Sheet (cdn.shopify.com/s/files/1/0630/8950/8583/files/OAK-D_Spec_Sheet.pdf)"
_OAK_LITE = "Luxonis, OAK-D Lite product page (docs.luxonis.com/hardware/products/OAK-D%20Lite)"
_DM9095 = "Luxonis, OAK-D-Lite (docs.luxonis.com/projects/hardware/en/latest/pages/DM9095)"
_HACKSTER = "OAK-D Lite, shop description (hackster.io/products/buy/106357)"
_OAK_ACCURACY = (
    "Luxonis, Depth Accuracy (docs.luxonis.com/projects/hardware/en/latest/pages/guides/depth_accuracy)"
)
_OAK_SEARCH = (
    "Luxonis, StereoDepth documentation (github.com/luxonis/depthai-python, commit b83bd0dd:"
    " 'a fixed 95 pixel disparity search')"
)
_D400_SEARCH = (
    "RealSense staff, 'a hard limit of the silicon' (github.com/realsenseai/librealsense/issues/7127)"
)
_D400_TUNING = (
    "Tuning depth cameras for best performance"
    " (dev.intelrealsense.com/docs/tuning-depth-cameras-for-best-performance)"
)
_D400_SUBPIXEL = (
    "White paper, Subpixel linearity improvement (dev.intelrealsense.com/docs/"
    "white-paper-subpixel-linearity-improvement-for-intel-realsense-depth-cameras)"
)
_D400_TABLE = "D400 module table (huggingface.co TableSenseAI/FreeformTableQA, feta_11391.html)"
_D400_RANGES = "RealSense staff (github.com/realsenseai/librealsense/issues/7631)"
_D405_SPECS = "RealSense staff, from the comparison chart (github.com/realsenseai/librealsense/issues/11427)"
_D405_MIN_Z = "RealSense staff, from the data sheet (github.com/realsenseai/realsense-ros/issues/2367)"
_D415_PAGE = "D415 product page (realsenseai.com/products/stereo-depth-camera-d415), read in quotation only"
_D435_PAGE = "D435i product page (realsenseai.com/products/depth-camera-d435i), read in quotation only"
_D415_SHIFT = "Intel community, from the tuning guide (community.intel.com, thread 676278)"
_D435_SPECS = _HEARSAY + "a list of specifications (community.intel.com, thread 676278)"
_D455_SHEET = (
    "D400 data sheet 337029-009 (realsenseai.com/wp-content/uploads/2020/06/"
    "Intel-RealSense-D400-Series-Datasheet-June-2020.pdf), read in quotation only"
)
_D435_ACCURACY = (
    _HEARSAY
    + "'in the datasheet', not contradicted by staff (github.com/realsenseai/librealsense/issues/7806)"
)
_D400_ACCURACY = "RealSense staff (github.com/realsenseai/librealsense/issues/7806)"
_D400_ACCURACY_NOTE = "'2.5 mm to 5 mm is expected with 400 Series cameras': the worse end"
_D455_ACCURACY = "RealSense staff, from the press release (github.com/realsenseai/librealsense/issues/6697)"
_D405_OLD_SHEET = _HEARSAY + "the data sheet of 2022 (github.com/realsenseai/librealsense/issues/15016)"
_D405_DIGIKEY = (
    "DigiKey, from the data sheet (forum.digikey.com/t/the-intel-realsense-depth-camera-d405/50822)"
)
_ZED_LENS = (
    "Stereolabs, camera focal length and field of view"
    " (support.stereolabs.com/hc/en-us/articles/360007395634)"
)
_ZED_URDF = "Stereolabs, zed_macro.urdf.xacro (github.com/stereolabs/zed-ros-wrapper)"
_ZED_RANGE = "Stereolabs, Depth Settings (stereolabs.com/docs/depth-sensing/depth-settings)"
_ZED_FOV = "Stereolabs support (community.stereolabs.com/t/zed2i-fov-exact-values/2102)"
_ZED_MODE = "a camera's log (github.com/stereolabs/zed-ros-wrapper/issues/877); size of HD720: " + _ZED_LENS
_ZED_CLEARPATH = (
    "Clearpath Robotics, ZED 2i"
    " (docs.clearpathrobotics.com/docs_robots/accessories/sensors/cameras/stereolabs_zed_2)"
)


def _size(width: int, height: int, source: str, note: str = "") -> tuple[Figure, Figure]:
    return Figure("width_px", width, source, note), Figure("height_px", height, source, note)


def _accuracy(source: str, note: str, *claims: tuple[float, float]) -> tuple[Figure, ...]:
    return tuple(Figure("accuracy_pct", pct, source, note, metres * 1e3) for pct, metres in claims)


CAMERAS: tuple[CommercialCamera, ...] = (
    CommercialCamera(
        "oak-d",
        "Luxonis OAK-D",
        (
            Figure("baseline_mm", 75, _OAK_FAQ),
            Figure("baseline_mm", 750, _OAK_D, "'75cm', a misprint for 75 mm"),
            Figure("focal_px", 882.5, _OAK_FAQ, "at 800P; 71.9 deg"),
            Figure("hfov_deg", 72, _OAK_D),
            Figure("hfov_deg", 80, _OAK_SHEET),
            Figure("vfov_deg", 49, _OAK_D),
            Figure("vfov_deg", 55, _OAK_SHEET),
            *_size(1280, 800, _OAK_SHEET),
            Figure("min_depth_mm", 700, _OAK_FAQ, "at 800P"),
            Figure("min_depth_mm", 400, _OAK_D, "at 400P, or 800P with extended disparity"),
            Figure("min_depth_mm", 200, _OAK_D, "at 400P with extended disparity"),
            Figure("max_disparity_px", 95, _OAK_SEARCH),
            *_accuracy(_OAK_ACCURACY, "'below', median device", (2, 4), (4, 7), (6, 10.5)),
        ),
    ),
    CommercialCamera(
        "oak-d-lite",
        "Luxonis OAK-D Lite",
        (
            Figure("baseline_mm", 75, _HACKSTER),
            Figure("baseline_mm", 750, _OAK_LITE, "'75cm', a misprint for 75 mm"),
            Figure("hfov_deg", 73, _OAK_LITE),
            Figure("vfov_deg", 58, _OAK_LITE),
            *_size(640, 480, _DM9095),
            Figure("min_depth_mm", 400, _HACKSTER, "near end of the ideal range"),
            Figure("min_depth_mm", 800, _OAK_LITE, "'800P', which this sensor does not have"),
            Figure("max_disparity_px", 95, _OAK_SEARCH, "written of the OAK-D, which has the same processor"),
            *_accuracy(_OAK_ACCURACY, "'below', median device", (2, 3), (4, 6), (6, 8)),
        ),
    ),
    CommercialCamera(
        "d405",
        "RealSense D405",
        (
            Figure("baseline_mm", 18, _D405_MIN_Z),
            Figure("hfov_deg", 84, _D405_SPECS),
            Figure("hfov_deg", 87, _D405_SPECS, "of the colour picture, from the same imager"),
            Figure("hfov_deg", 79.88, _D405_MIN_Z, "from one camera's focal length, 382.259 px at 640x480"),
            Figure("vfov_deg", 58, _D405_SPECS),
            *_size(1280, 720, _D400_TABLE, "largest depth picture of the D400 modules"),
            Figure("min_depth_mm", 100, _D405_DIGIKEY, "at 1280x720"),
            Figure("min_depth_mm", 70, _D405_DIGIKEY, "at 848x480"),
            Figure("min_depth_mm", 40, _D405_DIGIKEY, "at 424x240"),
            Figure("min_depth_mm", 70, _D405_SPECS, "resolution not said"),
            Figure("max_disparity_px", 126, _D400_SEARCH),
            *_accuracy(_D405_SPECS, "'<'", (2, 0.5)),
            *_accuracy(_D405_OLD_SHEET, "'<='", (1.4, 0.2)),
        ),
    ),
    CommercialCamera(
        "d415",
        "RealSense D415",
        (
            Figure("baseline_mm", 55, _D415_PAGE),
            Figure("hfov_deg", 65, _D400_SUBPIXEL),
            Figure("hfov_deg", 63.4, _D400_TABLE),
            Figure("vfov_deg", 40.4, _D400_TABLE),
            *_size(1280, 720, _D400_TUNING, "recommended"),
            Figure("min_depth_mm", 450, _D415_SHIFT, "at disparity shift 0"),
            Figure("min_depth_mm", 300, _D400_RANGES, "resolution not said"),
            Figure("min_depth_mm", 160, _D400_TABLE, "resolution not said"),
            Figure("max_disparity_px", 126, _D400_SEARCH),
            *_accuracy(_D400_ACCURACY, _D400_ACCURACY_NOTE, (0.5, 1)),
        ),
    ),
    CommercialCamera(
        "d435",
        "RealSense D435",
        (
            Figure("baseline_mm", 50, _D435_SPECS),
            Figure("hfov_deg", 90, _D400_SUBPIXEL),
            Figure("hfov_deg", 87, _D435_PAGE),
            Figure("hfov_deg", 85.2, _D400_TABLE, "of the D430 module, 16:9"),
            Figure("vfov_deg", 58, _D400_TABLE, "of the D430 module, 16:9"),
            *_size(848, 480, _D400_TUNING, "recommended"),
            *_size(1280, 720, _D400_TABLE, "largest, of the D430 module"),
            Figure("min_depth_mm", 280, _D435_PAGE, "resolution not said"),
            Figure("min_depth_mm", 110, _D400_TABLE, "resolution not said"),
            Figure("min_depth_mm", 100, _D400_RANGES, "resolution not said"),
            Figure("max_disparity_px", 126, _D400_SEARCH),
            *_accuracy(_D400_ACCURACY, _D400_ACCURACY_NOTE, (0.5, 1)),
            *_accuracy(_D435_ACCURACY, "'<'", (2, 2)),
        ),
    ),
    CommercialCamera(
        "d455",
        "RealSense D455",
        (
            Figure("baseline_mm", 95, _D455_SHEET),
            Figure("hfov_deg", 87, _D455_SHEET, "at HD"),
            Figure("hfov_deg", 86, "RealSense staff (github.com/realsenseai/librealsense/issues/6697)"),
            Figure("hfov_deg", 75, _D455_SHEET, "at VGA"),
            Figure("vfov_deg", 58, _D455_SHEET, "at HD"),
            *_size(
                848, 480, "RealSense staff (github.com/realsenseai/librealsense/issues/9241)", "recommended"
            ),
            *_size(1280, 720, _D455_SHEET, "HD"),
            *_size(640, 480, _D455_SHEET, "VGA"),
            Figure(
                "min_depth_mm",
                340,
                "RealSense staff (github.com/realsenseai/librealsense/issues/9241)",
                "at 848x480",
            ),
            Figure("min_depth_mm", 400, "RealSense staff (github.com/realsenseai/librealsense/issues/9977)"),
            Figure(
                "min_depth_mm",
                520,
                "Servi et al., Sensors 21(22):7770 (doi.org/10.3390/s21227770), read in quotation only",
                "at 1280x720",
            ),
            Figure("max_disparity_px", 126, _D400_SEARCH),
            *_accuracy(_D455_ACCURACY, "'less than'", (2, 4)),
            *_accuracy(_D400_ACCURACY, _D400_ACCURACY_NOTE, (0.5, 1)),
        ),
    ),
    CommercialCamera(
        "zed-2i",
        "Stereolabs ZED 2i",
        (
            Figure("baseline_mm", 120, _ZED_URDF),
            Figure("hfov_deg", 92.8, _ZED_FOV, "rectified, one user's camera, mode not said"),
            Figure("hfov_deg", 110, _ZED_FOV, "'max.', raw picture before rectification"),
            Figure("vfov_deg", 70, _ZED_FOV, "'max.', raw picture before rectification"),
            *_size(1280, 720, _ZED_MODE, "HD720"),
            Figure("min_depth_mm", 300, _ZED_RANGE, "2.1 mm lens; 500 with the 4 mm lens"),
            Figure("min_depth_mm", 200, _ZED_CLEARPATH),
        ),
    ),
    CommercialCamera(
        "zed-mini",
        "Stereolabs ZED Mini",
        (
            Figure("baseline_mm", 63, _ZED_LENS),
            Figure("baseline_mm", 60, _ZED_URDF),
            Figure("focal_px", 700, _ZED_LENS, "at HD720"),
            Figure("focal_px", 1400, _ZED_LENS, "at HD2K, 2208x1242"),
            Figure("hfov_deg", 85, _ZED_LENS, "at HD720"),
            Figure("hfov_deg", 76, _ZED_LENS, "at HD2K"),
            Figure("vfov_deg", 54, _ZED_LENS, "at HD720"),
            *_size(1280, 720, _ZED_LENS, "HD720"),
            *_size(2208, 1242, _ZED_LENS, "HD2K"),
            Figure("min_depth_mm", 100, _ZED_RANGE),
        ),
    ),
)
"""Every camera."""
