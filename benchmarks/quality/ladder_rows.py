"""The rows of the ladder: which scene each is trained on and with what settings, and the meshes it is measured beside."""

NO_SEMANTICS = "data.semantics=false"
NO_COUPLING = "semantic.coupling_strength=0"  # as in the release: labels are learned, geometry gets no gradient from them
NO_GEOMETRY = ["loss.pearson=0", "loss.normal_consistency=0", "loss.normal_boundary=0"]
PHOTOMETRIC = NO_GEOMETRY + ["data.prior_depth=none"]
# The multi-view terms as preset pgsr has them, every fifth step, where they cost a fifth.
MULTI_VIEW = ["loss.multi_view_geometric=0.03", "loss.multi_view_photometric=0.15", "loss.multi_view_every=5"]
# The prior depth as the default preset uses it, acting as early.
PGSR_PRIOR = ["data.prior_depth=auto", "loss.log_depth=0.5", "loss.log_depth_end=0.02", "loss.depth_start=0",
              "loss.depth_align_every=500", "loss.normal_start=500"]
THREE_DGS = PHOTOMETRIC + ["loss.flatten=0", "densify.gradient_abs=0", "mesh.depth=median"]
UNPROJECTED = ["init.start=depth"]  # the start is depth unprojected with the cameras of the row, not the points of the scene
# Options of `aligngs refine`.
CAMERAS_ONLY = ["--no-stereo", "--no-planes", "--no-exposure"]
NO_LABELS_YET = ["--no-planes"]  # cameras and stereo: this separates the effect of semantics in training from that before
COUPLING = ["semantic.coupling_strength=0.1"]  # bounded: a tenth of the photometric gradient
UNCOUPLED = "stereo, uncoupled"
COUPLED = "stereo, coupled"
PLACEBOS = ["stereo, placebo constant", "stereo, placebo shuffled", "stereo, placebo opacity"]
# The controls of all that labels do, planes included: nothing, one class everywhere, names without meaning.
LABEL_CONTROLS = ["stereo, no semantics", "default, refined, constant labels", "default, refined, shuffled labels"]
# The yardstick for a row with labels: the best of these, pair by pair.
CONTROLS = {COUPLED: PLACEBOS, "default, refined": LABEL_CONTROLS}

# Parts of preset default, each left out alone: this decides on the development rooms what is on. Without planes: "stereo, uncoupled".
WITHOUT = {
    "log depth": ["loss.log_depth=0", "loss.pearson=0"], "prior normals": ["loss.prior_normal=0"], "normal consistency": ["loss.normal_consistency=0"],
    "free space": ["densify.free_space_every=0"], "dense start": ["init.start=cloud"],
    "sharpened labels": ["semantic.drawn_sharpness=0"], "opacity dropout": ["train.opacity_dropout=0"],
    "minimum splat size": ["optimizer.scale_min_pixels=0"],
}
# And what it leaves off, each switched on alone: settings, or options of `aligngs refine`.
WITH = {
    "coupling": COUPLING, "creases": ["loss.crease=0.02"], "multi-view terms": MULTI_VIEW, "MCMC growth": ["densify.strategy=mcmc"],
    "closed room": ["train.closed_room=true"], "stronger opacity dropout": ["train.opacity_dropout=0.4"],
    "opacity dropout of 0.2": ["train.opacity_dropout=0.2"], "shorter opacity dropout": ["train.opacity_dropout_stop=5600"],
    "no flattening": ["loss.flatten=0"], "weaker flattening": ["loss.flatten=1"], "stronger flattening": ["loss.flatten=10"],
    "stronger normal consistency": ["loss.normal_consistency=0.05"],
    "Pearson in place of log depth": ["loss.log_depth=0"],
    "weaker log depth": ["loss.log_depth=0.1", "loss.log_depth_end=0.004"],
    "planes in the loop": ["loss.plane_weight=1"], "planes in the loop, held": ["loss.plane_weight=1", "loss.log_depth_end=0.2"],
    "moving cameras": ["optimizer.pose_rotation=3e-4", "optimizer.pose_translation=3e-4"],
}
WITH_REFINED = {"planes of tables": ["--plane-tables"], "fused labels": ["--fuse-labels"]}


def file_name(name):
    """Letters and digits of a row's name, for files and folders."""
    return "".join(c if c.isalnum() else "_" for c in name)


class Row:
    """One way to train: which cloud and labels the scene has, how `aligngs refine` goes before, and the settings."""

    def __init__(self, name, preset, settings=(), cloud="feedforward", labels="teacher", refine=None, compare_with=(), depth="network"):
        self.name, self.preset, self.settings = name, preset, list(settings)
        self.cloud, self.labels, self.refine, self.depth = cloud, labels, refine, depth
        self.compare_with = [compare_with] if isinstance(compare_with, str) else list(compare_with)

    @property
    def folder(self):
        return file_name(self.name)


# Also in the paper's rows, which would take many minutes each otherwise. Classes that no teacher ranks among its two best share a
# channel (the tests ActiveClasses.* bound the effect on losses and labels). A step takes the semantic loss of a quarter of the pixels
# (docs/decisions/0013-small-settings.md measures it).
ACTIVE = ["semantic.active_top=2", "semantic.pixel_share=0.25"]


def paper_ladder(where="", refine=None, start=()):
    """The paper's Table III, cumulatively, L_sem also as in the release. `where` ends the rows' names, `refine` makes their cameras,
    `start` are settings of the feed-forward start."""
    steps = [("base (sparse start)", PHOTOMETRIC + [NO_SEMANTICS], []),
             ("+ feed-forward start", NO_GEOMETRY + [NO_SEMANTICS], ["base (sparse start)"]),  # the prior depth is where it starts
             ("+ L_sem, uncoupled", NO_GEOMETRY + ACTIVE + [NO_COUPLING], ["+ feed-forward start"]),
             ("+ L_sem, coupled", NO_GEOMETRY + ACTIVE, ["+ L_sem, uncoupled"]),
             ("+ L_d", ACTIVE + ["loss.normal_consistency=0", "loss.normal_boundary=0"], ["+ L_sem, coupled"]),
             ("+ L_ng + L_nb (paper)", ACTIVE, ["+ L_d", "base (sparse start)"])]
    return [Row(name + where, "paper", settings + (list(start) if k > 0 else []), cloud="sfm" if k == 0 else "feedforward", refine=refine,
                compare_with=[base + where for base in bases]) for k, (name, settings, bases) in enumerate(steps)]


# The paper starts from 100,000 points of the network's depth, unprojected with the cameras that it trains on. Those of the scene belong
# to the cameras before their adjustment, so that the rows with adjusted cameras unproject the depth anew (some 90,000 Gaussians).
ROWS = paper_ladder() + paper_ladder(", refined cameras", CAMERAS_ONLY, UNPROJECTED) + [
    Row("release-faithful", "paper", ACTIVE + [NO_COUPLING], compare_with="+ L_ng + L_nb (paper)"),
    Row("release-faithful, refined cameras", "paper", ACTIVE + [NO_COUPLING] + UNPROJECTED, refine=CAMERAS_ONLY,
        compare_with=["+ L_ng + L_nb (paper), refined cameras", "+ feed-forward start, refined cameras"]),
    Row("3dgs", "paper", THREE_DGS + [NO_SEMANTICS],
        compare_with="base (sparse start)"),
    Row("pgsr", "pgsr", compare_with="+ feed-forward start"),
    Row("pgsr + prior depth", "pgsr", PGSR_PRIOR, compare_with="pgsr"),
    Row("default", "default", compare_with="+ feed-forward start"),
    Row("default, refined cameras", "default", refine=CAMERAS_ONLY, compare_with="default"),
    Row(LABEL_CONTROLS[0], "default", [NO_SEMANTICS], refine=NO_LABELS_YET),
    Row(UNCOUPLED, "default", refine=NO_LABELS_YET, compare_with=LABEL_CONTROLS[0]),
    Row(COUPLED, "default", COUPLING, refine=NO_LABELS_YET, compare_with=[LABEL_CONTROLS[0], UNCOUPLED, *PLACEBOS]),
    Row(PLACEBOS[0], "default", COUPLING, refine=NO_LABELS_YET, labels="constant", compare_with=UNCOUPLED),
    Row(PLACEBOS[1], "default", COUPLING, refine=NO_LABELS_YET, labels="shuffled", compare_with=UNCOUPLED),
    Row(PLACEBOS[2], "default", COUPLING + ["semantic.coupling=opacity"], refine=NO_LABELS_YET, compare_with=UNCOUPLED),
    Row("stereo, true labels", "default", COUPLING, refine=NO_LABELS_YET, labels="true", compare_with=[LABEL_CONTROLS[0], UNCOUPLED, COUPLED]),
    Row("default, refined", "default", refine=[],
        compare_with=[*LABEL_CONTROLS, UNCOUPLED, "default, refined cameras", "pgsr + prior depth, refined cameras",
                      "pgsr + prior depth, refined cameras and start", "pgsr, the same scene", "pgsr, the same scene, default's fusion",
                      "+ L_ng + L_nb (paper)"]),
    Row("high, refined", "high", refine=[], compare_with="default, refined"),
    Row(LABEL_CONTROLS[1], "default", refine=[], labels="constant", compare_with=LABEL_CONTROLS[0]),
    Row(LABEL_CONTROLS[2], "default", refine=[], labels="shuffled", compare_with=LABEL_CONTROLS[0]),
    Row("default, refined, photos as exposed", "default", ["data.exposure=false"], refine=[], compare_with="default, refined"),
    Row("default, without stereo", "default", refine=["--no-stereo"], compare_with="default, refined"),
    Row("default, without square planes", "default", refine=["--no-square"], compare_with="default, refined"),
    Row("default, without panels", "default", refine=["--no-panels"], compare_with="default, refined"),
    *[Row(f"default, without {what}", "default", settings, refine=[], compare_with="default, refined") for what, settings in WITHOUT.items()],
    *[Row(f"default, with {what}", "default", settings, refine=[], compare_with="default, refined") for what, settings in WITH.items()],
    *[Row(f"default, with {what}", "default", refine=options, compare_with="default, refined") for what, options in WITH_REFINED.items()],
    Row("pgsr + prior depth, refined cameras", "pgsr", PGSR_PRIOR, refine=CAMERAS_ONLY, compare_with="pgsr + prior depth"),
    Row("pgsr + prior depth, refined cameras and start", "pgsr", PGSR_PRIOR + UNPROJECTED, refine=CAMERAS_ONLY,
        compare_with="pgsr + prior depth, refined cameras"),
    # As from structure from motion, without any network's depth: what labels do before training and in it.
    Row("depth measured, no labels", "default", [NO_SEMANTICS], cloud="sfm", refine=["--no-planes"], depth="measured"),
    Row("depth measured, labels in training alone", "default", cloud="sfm", refine=["--no-planes"], depth="measured",
        compare_with="depth measured, no labels"),
    Row("depth measured, shuffled labels", "default", cloud="sfm", labels="shuffled", refine=[], depth="measured",
        compare_with="depth measured, no labels"),
    Row("depth measured, constant labels", "default", cloud="sfm", labels="constant", refine=[], depth="measured",
        compare_with="depth measured, no labels"),
    Row("depth measured", "default", cloud="sfm", refine=[], depth="measured",
        compare_with=["depth measured, no labels", "depth measured, labels in training alone", "depth measured, shuffled labels",
                      "depth measured, constant labels"]),
    # All that `aligngs refine` finds out is given to pgsr, its dense start included: what is left is training alone.
    Row("pgsr, the same scene", "pgsr", PGSR_PRIOR + UNPROJECTED, refine=[], compare_with="pgsr + prior depth, refined cameras"),
]
PRIOR, CEILING = "TSDF of the prior depth", "TSDF of the true depth (ceiling)"
REFINED_PRIOR = "TSDF of the refined depth, no training"


class Yardstick:
    """A mesh that no training has touched, with the cameras of the scene that `refine` makes. `prior`: the depth is that of the
    scene with these options of `refine` instead, None for the scene's own."""

    def __init__(self, name, option, refine=None, prior=None):
        self.name, self.option, self.refine, self.prior = name, option, refine, prior


# The prior is the network's own depth (a smooth factor per photo at most), with the very cameras of the row.
YARDSTICKS = {
    "default": [Yardstick(PRIOR, "--from-prior"), Yardstick(CEILING, "--from-truth")],
    "default, refined": [Yardstick(PRIOR + ", refined cameras", "--from-prior", [], CAMERAS_ONLY),
                         Yardstick(REFINED_PRIOR, "--from-prior", []),
                         Yardstick(CEILING + ", refined cameras", "--from-truth", [])],
}
# Rows whose mesh is fused once more, with the settings of preset default. This separates the effect of fusion from that of training.
FUSED_AS_DEFAULT = {"pgsr, the same scene": "pgsr, the same scene, default's fusion"}
COLUMNS = [
    ("psnr", "PSNR", 2, "nvs.psnr"), ("fitted", "colour-fitted", 2, "nvs.exposure_fitted.psnr"),
    ("posed", "pose-fitted", 2, "nvs.pose_refined.psnr"),
    ("between", "between", 2, "nvs.interpolating.psnr"),
    ("beyond", "beyond", 2, "nvs.extrapolating.psnr"), ("ssim", "SSIM", 3, "nvs.ssim"),
    ("accuracy", "Acc (m)", 4, "geometry.accuracy"), ("completeness", "Comp (m)", 4, "geometry.completeness"),
    ("precision", "Prec", 3, "geometry.precision"), ("recall", "Recall", 3, "geometry.recall"),
    ("fscore", "F", 3, "geometry.fscore"), ("fscore_2cm", "F at 2 cm", 3, "geometry.fscore_2cm"), ("fscore_1cm", "F at 1 cm", 3, "geometry.fscore_1cm"),
    ("normals", "normals (deg)", 2, "geometry.surface.normal_error_median_deg"),
    ("structure", "on structure", 2, "geometry.surface.structure_normal_error_median_deg"),
    ("roughness", "roughness (deg)", 2, "geometry.surface.roughness_median_deg"),
    ("pinholes", "pinholes", 4, "geometry.surface.pinholes"), ("area", "F (area)", 3, "geometry.variants.area_samples, all poses.fscore"),
    ("aligned", "F, aligned", 3, "geometry.variants.neuris_vertices, all poses, alignment: cameras.fscore"),
    ("miou", "mIoU", 3, "semantics.miou"), ("teacher", "teacher's", 3, "semantics.teacher.miou"),
    ("miou_present", "mIoU, all present", 3, "semantics.present.miou"),
    ("teacher_present", "teacher's, all present", 3, "semantics.teacher.present.miou"),
    ("mesh_miou", "mesh mIoU", 3, "semantics.mesh.miou"),
    ("seconds", "processor s", 0, None),
]
PAIR = ("room", "room_seed", "seed")  # what runs are compared by
GEOMETRY = ("accuracy", "completeness", "precision", "recall", "fscore", "fscore_2cm", "fscore_1cm", "normals", "structure", "roughness",
            "pinholes", "area", "aligned")
