//! Scenes that have every key of the reference between them.

/// Every key of the reference, in scenes that are accepted.
pub(crate) const ALL_KEYS: [&str; 17] = [
    r#"version = 1
    [sheet]
    name = "main"
    mesh = { square = { side = 0.2, level = 1 } }
    density = 0.1
    mass = 0.01
    thickness = 1e-4
    isometry = { elastic = { stiffness = 1e6, poisson = 0.3, limit = 0.02 } }
    bending = { plate = { rigidity = 1e-3, poisson = 0.25 } }
    yield = { moment = 0.1, hardening = 1e-4, layers = 4 }
    damping = 1.0
    refine = 1
    placement = { position = [0, 0, 1], turn = { axis = [0, 0, 1], angle = 45 } }
    start = { perturbation = 0.01, seed = 3, velocity = [1, 0, 0], spin = { axis = [0, 0, 1], rate = 90, centre = [0, 0, 0] }, file = { path = "a.obj", scale = 1.0, up = "y", polygons = "refuse", frame = "folded" } }
    [[crease]]
    sheet = "main"
    at = { ends = [[0, 1]] }
    stiffness = 0.1
    angle = { sine = { mean = 1, amplitude = 2, frequency = 3, phase = 4 } }
    yield = { moment = 0.01, hardening = 0.001, layers = 2 }
    [[crease]]
    name = "lid"
    at = { line = { from = [0, 0, 0], to = [1, 1, 0] } }
    stiffness = 0.1
    angle = { keyframes = { interpolation = "monotone_cubic", keys = [[0, 0], [1, 90]] } }
    [[glue]]
    sheets = ["main", "main"]
    first = { vertices = [0] }
    second = { line = { from = [0, 0, 0], to = [1, 0, 0] } }
    closing = 0.0
    stiffness = 10.0
    [[glue]]
    first = { vertices = [0] }
    second = { vertices = [5] }
    bend = { stiffness = 0.1, angle = 10 }
    [[weight]]
    sheet = "main"
    at = { vertices = [1] }
    mass = 1e-3
    [[support]]
    sheet = "main"
    at = { nearest = [[0, 0, 0]] }
    hold = { curve = { shape = { line = { point = [0, 0, 0], direction = [1, 0, 0] } }, motion = { x = 1.0 } } }
    [[support]]
    at = { vertices = [1] }
    hold = { surface = { shape = { plane = { point = [0, 0, 0], normal = [0, 0, 1] } }, side = "outside",
        motion = { y = 1, z = { ramp = { from = 0, to = 1, begin = 0, end = 1 } } } } }
    [[support]]
    at = { box = { min = [0, 0, 0], max = [1, 1, 1] } }
    hold = { moving_pin = { rotation = { centre = [0, 0, 0], axis = [0, 0, 1], angle = 5 } } }
    [[support]]
    at = { half_space = { point = [0, 0, 0], normal = [0, 0, 1] } }
    hold = "pin"
    [[support]]
    at = "boundary"
    hold = { surface = { shape = { sphere = { centre = [0, 0, 0], radius = 1 } }, side = "inside" } }
    [[support]]
    at = "all"
    hold = { surface = { shape = { cylinder = { point = [0, 0, 0], axis = [0, 0, 1], radius = 1 } }, side = "on" } }
    [[obstacle]]
    name = "table"
    shape = { box = { size = [1, 1, 1] } }
    pose = { position = [0, 0, -3] }
    motion = { x = { run_up = { from = 0, rate = 0.1, begin = 0, end = 1 } }, z = { smooth_step = { to = 1, end = 1 } } }
    friction = 0.1
    [[obstacle]]
    shape = { sphere = { radius = 1 } }
    [[obstacle]]
    shape = { cylinder = { radius = 1, height = 1 } }
    [[obstacle]]
    shape = { capsule = { radius = 1, length = 1 } }
    [[obstacle]]
    shape = { prism = { outline = { regular = { sides = 6, radius = 1 } }, height = 1 } }
    [[obstacle]]
    shape = { frame = { outer = 2, opening = 1, bottom = 0, top = 0.1 } }
    [[obstacle]]
    shape = { wall = { line = [[0, 0], [1, 0], [1, 1]], corner_radius = 0.1, width = 1 } }
    [[obstacle]]
    shape = { file = { path = "b.obj" } }
    [[obstacle]]
    shape = "half_space"
    [[obstacle]]
    shape = { triangles = { vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0]], faces = [[0, 1, 2]] } }
    [forces]
    gravity = [0, 0, -9.81]
    [[forces.load]]
    sheet = "main"
    at = "all"
    direction = [1, 0, 0]
    size = 1.0
    [[forces.acceleration]]
    direction = [1, 0, 0]
    size = 1
    [air]
    density = 1.2
    normal = 1.1
    tangential = 0.01
    wind = [{ sine = { mean = 2, amplitude = 1, frequency = 0.5 } }, 1, 0]
    [air.attached]
    sheet = "main"
    trailing = "boundary"
    rows = 20
    [contact]
    self_contact = true
    friction = { static = 0.2, kinetic = 0.1 }
    activation = 1e-3
    stiffness = 1e-3
    rest_speed = 1e-3
    [[contact.pair]]
    sheets = ["main", "main"]
    friction = 0.1
    [[measure]]
    name = "height"
    sheet = "main"
    at = "all"
    quantity = "z"
    [[measure]]
    name = "x"
    at = { vertices = [0] }
    quantity = "x"
    [[measure]]
    name = "y"
    at = { vertices = [0] }
    quantity = "y"
    [[measure]]
    name = "away"
    at = { vertices = [0] }
    quantity = "displacement"
    [[measure]]
    name = "from-origin"
    at = "boundary"
    quantity = { distance_to_point = [0, 0, 0] }
    [[measure]]
    name = "width"
    at = { vertices = [0] }
    quantity = { distance_to = { vertices = [1] } }
    [[measure]]
    name = "opening"
    at = "all"
    quantity = { angle_to = "all" }
    [[measure]]
    name = "fold"
    crease = "lid"
    quantity = "fold_angle"
    [[measure]]
    name = "moment"
    crease = "lid"
    quantity = "moment"
    [[measure]]
    name = "moment-per-length"
    crease = "lid"
    quantity = "moment_per_length"
    [method]
    integrator = "implicit_euler"
    step = 0.01
    strain_tolerance = 1e-10
    max_iterations = 50
    rod_stiffness = 1e5
    accuracy = 1e-4
    min_fraction = 0.1
    max_factorisations = 600
    fallback = "implicit_euler"
    taut = "stop"
    [stop]
    time = 2
    rest = { speed = 1e-3, duration = 0.1 }
    support_force = 10
    [output]
    frames_per_second = 25
    checkpoint_interval = 1
    trajectory = false
    obj = true
    page = false
    curvature = true"#,
    r#"version = 1
    [sheet]
    mesh = { rectangle = { width = 1, height = 1, columns = 2, rows = 2, diagonals = "union_jack" } }
    isometry = { elastic = { stiffness = 1e5 } }
    bending = { hinges = { rigidity = 1e-3 } }
    [[crease]]
    at = { pattern = "assigned" }
    stiffness = 1
    [[crease]]
    at = { pattern = "mountains" }
    stiffness = 1
    angle = { keyframes = { interpolation = "linear", keys = [[0, 0]], kinks = [0] } }
    [[crease]]
    at = { pattern = "valleys" }
    stiffness = 1
    [[crease]]
    at = { pattern = "flat" }
    stiffness = 1
    [[crease]]
    at = { pattern = "zigzags" }
    stiffness = 1
    [[support]]
    at = "all"
    hold = { curve = { shape = { circle = { centre = [0, 0, 0], normal = [0, 0, 1], radius = 1 } } } }
    [[support]]
    at = "all"
    hold = { curve = { shape = { polyline = { points = [[0, 0, 0], [1, 0, 0], [1, 1, 0]], corner_radius = 0.1 } } } }
    [[support]]
    at = "all"
    hold = { curve = { shape = { spline = { points = [[0, 0, 0], [1, 0, 0], [1, 1, 0]] } } } }
    [[support]]
    at = "all"
    hold = { curve = { shape = { closed_spline = { points = [[0, 0, 0], [1, 0, 0], [1, 1, 0]] } } } }
    [method]
    integrator = "bdf2"
    taut = "refuse""#,
    r#"version = 1
    [sheet]
    mesh = { file = { path = "a.obj", up = "z", polygons = "triangulate", mesh = "panel" } }
    material = { youngs = 7e10, thickness = 1e-4, density = 2700, poisson = 0.3, yield_stress = 1e8 }
    isometry = "rods"
    bending = "none"
    [method]
    integrator = "rattle"
    fallback = "refuse""#,
    r#"version = 1
    [sheet]
    mesh = { square = { side = 1, level = 1 } }
    [method]
    integrator = "chart"
    [method.chart]
    coordinates = "front"
    scheme = "forward_euler"
    equations = "published"
    positions = "linear"
    solver = "cramer"
    substep = { adaptive = { tolerance = 1e-6, min = 1e-6, max = 0.1 } }
    singular = "refuse""#,
    r#"version = 1
    [sheet]
    name = "main"
    mesh = { file = { path = "a.fold" } }
    material = "card"
    [folding]
    sheet = "main"
    time = 1
    stiffness = 0.01
    flat_stiffness = 0.5
    part = 0.75
    order = ["mountains", { edges = [0] }, { drawn = ["layer:Wing", "red"] }, "valleys"]
    frame = 1
    [[measure]]
    name = "wing"
    fold = { edges = [0] }
    quantity = "fold_angle""#,
    r#"version = 1
    [sheet]
    mesh = { file = { path = "a.fold" } }
    material = "card"
    [folding]
    time = 1
    stiffness = 0.01
    course = { ramp = { to = 0.5, end = 1 } }
    [[glue]]
    first = { nearest = [[0, 0, 0], [0.1, 0, 0]] }
    second = { nearest = [[0, 0.1, 0], [0.1, 0.1, 0]] }
    from = 0.5"#,
    r#"version = 1
    [sheet]
    mesh = { square = { side = 0.2, level = 1 } }
    rest = "flat"
    start = { positions = [[0, 0, 0], [1, 0, 0]], velocities = [[0, 0, 1], [0, 1, 0]] }
    bending = { orthotropic = { direction = [1, 0, 0], along = 2e-3, across = 1e-3, twist = 1e-3, coupling = 3e-4 } }
    curl = { along = [1, 0, 0], radius = 0.1, across_radius = 1.0, profile = { ramp = { from = 0, to = 1, begin = 0, end = 1 } } }
    [[support]]
    at = { vertices = [0, 1] }
    hold = "clamp"
    [[support]]
    at = { vertices = [2, 3] }
    hold = { moving_clamp = { poses = { frame = { position = [0, 0, 0], orientation = [1, 0, 0, 0] }, keys = [{ time = 0, position = [0, 0, 0], orientation = [1, 0, 0, 0] }], kinks = [0] } } }
    [[support]]
    at = { vertices = [4, 5] }
    hold = { sliding_clamp = { direction = [1, 0, 0], motion = { z = 0.0 } } }
    [stop]
    time = 1
    "#,
    r#"version = 1
    [sheet]
    mesh = { square = { side = 0.2, level = 1 } }
    rest = "mesh"
    bending = { plate = { rigidity = 1e-3, poisson = 0.3 } }
    [stop]
    time = 1
    "#,
    r#"version = 1
    [sheet]
    mesh = { file = { path = "flat.obj" } }
    bending = { plate = { rigidity = 1e-3 } }
    curl = { shape = { path = "bowl.obj", scale = 0.001, up = "y", polygons = "refuse", frame = "folded", mesh = "bowl" } }
    [stop]
    time = 1
    "#,
    r#"version = 1
    [sheet]
    mesh = { square = { side = 0.2, level = 1 } }
    material = { youngs = 1e9, youngs_across = 5e8, shear = 3e8, thickness = 1e-3, density = 800 }
    direction = [1, 0, 0]
    curl = { curvature = 5.0, across_curvature = -2.0, twist = 3.0 }
    swell = { smooth_step = { to = -0.002, end = 1 } }
    stiffening = { ramp = { from = 0.5, to = 1, end = 1 } }
    isometry = { elastic = { stiffness = 4e5, across = 2e5, shear = 1e5 } }
    [[sheet.patch]]
    at = { half_space = { point = [0.05, 0, 0], normal = [1, 0, 0] } }
    material = "cotton"
    direction = [0, 1, 0]
    density = 0.3
    [[sheet.patch]]
    at = { faces = [3, 0] }
    material = "card"
    [stop]
    time = 1
    "#,
    r#"version = 1
    [sheet]
    name = "cover"
    mesh = { square = { side = 0.2, level = 1 } }
    density = 0.1
    [[body]]
    name = "wheel"
    shape = { cylinder = { radius = 0.1, height = 0.1 } }
    sides = 16
    density = 1000
    pose = { position = [0, 0, 3], turn = { axis = [1, 0, 0], angle = 90 } }
    spin = { axis = [0, 1, 0], rate = 360 }
    guide = { hinge = { point = [0, 0, 3], axis = [0, 1, 0], stiffness = 0.1, rest = { ramp = { to = 90, end = 1 } }, damping = 0.01 } }
    torque = [{ axis = [0, 1, 0], size = 0.1 }]
    [[body]]
    shape = { box = { size = [0.1, 0.1, 0.1] } }
    mass = 0.1
    pose = { position = [0, 0, 2] }
    velocity = [1, 0, 0]
    guide = { slider = { direction = [1, 0, 0], stiffness = 10, rest = 0.1, damping = 1 } }
    force = [{ direction = [1, 0, 0], size = { sine = { amplitude = 1, frequency = 1 } }, at = [0, 0, 2] }]
    [[body]]
    shape = { file = { path = "block.obj" } }
    mass = 0.1
    pose = { position = [0, 0, 5] }
    [[body]]
    shape = { sphere = { radius = 0.1 } }
    mass = 0.1
    pose = { position = [0, 0, 4] }
    guide = { ball = { point = [0, 0, 4.2] } }
    [[glue]]
    sheets = ["cover", "wheel"]
    first = { vertices = [0, 1] }
    [stop]
    time = 1
    "#,
    r#"version = 1
    [[sheet]]
    name = "film"
    mesh = { square = { side = 0.2, level = 1 } }
    [[sheet]]
    name = "plate"
    mesh = { square = { side = 0.2, level = 1 } }
    placement = { position = [0, 0, 0.01] }
    [[glue]]
    sheets = ["film", "plate"]
    first = { vertices = [0, 1] }
    second = { vertices = [0, 1] }
    from = 0.1
    until = { force = 2.0 }
    [[support]]
    sheet = "film"
    at = "all"
    until = { measure = { name = "height", above = 0.1 } }
    [[support]]
    sheet = "plate"
    at = "all"
    from = { measure = { name = "height", below = -0.1 } }
    until = 0.5
    [[measure]]
    name = "height"
    at = { vertices = [0] }
    quantity = "z"
    [contact]
    self_contact = true
    [[contact.pair]]
    sheets = ["film", "plate"]
    friction = 0.1
    from = 0.2
    until = 0.4
    "#,
    r#"version = 1
    [[sheet]]
    name = "lower"
    mesh = { square = { side = 0.2, level = 1 } }
    material = "PET film"
    [[sheet]]
    name = "upper"
    mesh = { square = { side = 0.2, level = 1 } }
    material = "PET film"
    placement = { position = [0, 0, 0.01] }
    [[forces.pressure]]
    name = "lift"
    sheets = ["lower", "upper"]
    at = "all"
    size = 10
    [[forces.gas]]
    name = "bag"
    sheets = ["lower", "upper"]
    ambient = 1e5
    pressure = 1.1e5
    exponent = 1.4
    added = { smooth_step = { to = 1e-3, end = 1 } }
    [[measure]]
    name = "bag-pressure"
    enclosed = "bag"
    quantity = "pressure"
    [[measure]]
    name = "bag-gauge"
    enclosed = "bag"
    quantity = "gauge_pressure"
    [[measure]]
    name = "bag-volume"
    enclosed = "bag"
    quantity = "volume"
    [[forces.moment]]
    sheet = "upper"
    at = { half_space = { point = [0.1999, 0, 0], normal = [1, 0, 0] } }
    axis = [0, 1, 0]
    size = 1e-3
    [[forces.load]]
    sheet = "upper"
    at = { vertices = [0] }
    direction = [0, 0, 1]
    frame = "sheet"
    size = 1e-3
    [[forces.load]]
    at = "boundary"
    direction = [0, 0, 1]
    frame = "space"
    size = 1e-3
    [stop]
    time = 1
    "#,
    r#"version = 1
    [sheet]
    mesh = { file = { path = "shirt.obj" } }
    material = "office paper"
    direction = { uv = "u" }
    [[sheet.patch]]
    at = { group = "collar" }
    material = "card"
    [[support]]
    at = { vertices = [5] }
    hold = { follow = { sequence = { path = "body.npz" }, vertices = "nearest" } }
    [[obstacle]]
    shape = { sequence = { path = "body.npz", scale = 0.01, up = "y", delay = 0.5, outside = "rest" } }
    [[support]]
    at = { group = "hem" }
    hold = { follow = { sequence = { path = "walk/walk_*.obj", rate = 24, scale = 0.01, up = "y", delay = 0.5, outside = "refuse" }, vertices = "same_number" } }
    [[support]]
    at = { vertices = [3] }
    hold = { follow = { sequence = { path = "body.npz" }, vertices = { numbers = [7] } } }
    [stop]
    time = 1
    "#,
    r#"version = 1
    [sheet]
    mesh = { file = { path = "shirt.obj" } }
    material = "office paper"
    direction = { uv = "v" }
    [stop]
    time = 1
    "#,
    r##"version = 1
    [[sheet]]
    name = "drawn"
    mesh = { drawing = { path = "a.svg", spacing = 0.01, snap = 1e-4, unit = "mm", scale = 2, cut = ["black"],
        crease = ["layer:fold"], mountain = ["red"], valley = ["#0000ff"], flat = ["solid"], ignore = ["dashed"], seed = 1 } }
    density = 0.1
    [[sheet]]
    name = "in cm"
    mesh = { drawing = { path = "a.svg", spacing = 0.01, unit = "cm" } }
    density = 0.1
    [[sheet]]
    name = "in in"
    mesh = { drawing = { path = "a.svg", spacing = 0.01, unit = "in" } }
    density = 0.1
    [[sheet]]
    name = "in m"
    mesh = { drawing = { path = "a.svg", spacing = 0.01, unit = "m" } }
    density = 0.1
    [[sheet]]
    name = "in pt"
    mesh = { drawing = { path = "a.svg", spacing = 0.01, unit = "pt" } }
    density = 0.1
    [[sheet]]
    name = "in px"
    mesh = { drawing = { path = "a.svg", spacing = 0.01, unit = "px" } }
    density = 0.1
    [[sheet]]
    name = "listed"
    mesh = { triangles = { vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0]], faces = [[0, 1, 2]] } }
    density = 0.1
    start = { positions = [[0, 0, 0], [1, 0, 0], [0, 1, 0]], velocities = [[0, 0, 0], [0, 0, 0], [0, 0, 1]] }
    [[crease]]
    sheet = "drawn"
    at = { drawn = ["layer:fold", "red"] }
    stiffness = 0.1
    [[crease]]
    sheet = "drawn"
    at = { pattern = "unassigned" }
    stiffness = 0.1
    angle = 10
    [[obstacle]]
    shape = { triangles = { vertices = [[0, 0, -1], [1, 0, -1], [0, 1, -1]], faces = [[0, 1, 2]] } }"##,
    r#"version = 1
    [sheet]
    mesh = { square = { side = 0.2, level = 1 } }
    [[obstacle]]
    shape = { sequence = { frames = { times = [0, 1], positions = [[[0, 0, 9], [1, 0, 9], [0, 1, 9]], [[0, 0, 8], [1, 0, 8], [0, 1, 8]]], faces = [[0, 1, 2]] } } }
    [stop]
    time = 1"#,
];
