/* The systems of robins.navigation.strapdown with the sensor of robins.navigation.inertial_sensor, statement by statement:
   15 errors driven by an inertial sensor (QUASI_STATIC), or 21 with transients and no input (AUGMENTED is 1). */

enum { n = AUGMENTED ? 21 : 15, s = n + 1, m = 6, l = 6 };
enum { POSITION = 0, V = 3, THETA = 6, BA = 9, BG = 12, XF = 15, XW = 18 };
enum { Q0 = 6, FORCE = 16, RATE = 19 };

typedef struct {
    double dt, decay, gravity[3], rate[3], transport[3][3], noise[n], transient[6];
} Model;

static const double SMALL_ANGLE = 1e-4;

static void product(const double *p, const double *q, double *out) {
    double w = p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3], x = p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2];
    double y = p[0] * q[2] - p[1] * q[3] + p[2] * q[0] + p[3] * q[1], z = p[0] * q[3] + p[1] * q[2] - p[2] * q[1] + p[3] * q[0];
    out[0] = w, out[1] = x, out[2] = y, out[3] = z;
}

static void normalise(double *q) {
    double inverse = 1.0 / sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    for (int i = 0; i < 4; i++) q[i] *= inverse;
}

static void quaternion_exponential(const double *a, double scale, double *out) {
    double x = 0.5 * scale * a[0], y = 0.5 * scale * a[1], z = 0.5 * scale * a[2];
    double squared = x * x + y * y + z * z, angle = sqrt(squared);
    double sinc = angle < SMALL_ANGLE ? 1.0 - squared / 6.0 : sin(angle) / angle;
    out[0] = cos(angle), out[1] = sinc * x, out[2] = sinc * y, out[3] = sinc * z;
}

static void dcm(const double *q, double C[3][3]) {
    double w = q[0], x = q[1], y = q[2], z = q[3];
    C[0][0] = 1.0 - 2.0 * (y * y + z * z), C[0][1] = 2.0 * (x * y - w * z), C[0][2] = 2.0 * (x * z + w * y);
    C[1][0] = 2.0 * (x * y + w * z), C[1][1] = 1.0 - 2.0 * (x * x + z * z), C[1][2] = 2.0 * (y * z - w * x);
    C[2][0] = 2.0 * (x * z - w * y), C[2][1] = 2.0 * (y * z + w * x), C[2][2] = 1.0 - 2.0 * (x * x + y * y);
}

/* I + first [b x] + second [b x]^2 for b = scale a */
static void series(const double *a, double scale, double first, double second, double out[3][3]) {
    double x = scale * a[0], y = scale * a[1], z = scale * a[2], squared = x * x + y * y + z * z;
    out[0][0] = 1.0 + second * (x * x - squared), out[1][1] = 1.0 + second * (y * y - squared);
    out[2][2] = 1.0 + second * (z * z - squared);
    out[0][1] = second * x * y - first * z, out[1][0] = second * x * y + first * z;
    out[0][2] = second * x * z + first * y, out[2][0] = second * x * z - first * y;
    out[1][2] = second * y * z - first * x, out[2][1] = second * y * z + first * x;
}

static double length(const double *a) { return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]); }

static void dcm_exponential(const double *a, double scale, double out[3][3]) {
    double angle = fabs(scale) * length(a), first = 1.0 - angle * angle / 6.0, second = 0.5 - angle * angle / 24.0;
    if (!(angle < SMALL_ANGLE)) first = sin(angle) / angle, second = 2.0 * (sin(0.5 * angle) / angle) * (sin(0.5 * angle) / angle);
    series(a, scale, first, second, out);
}

static void right_jacobian(const double *a, double scale, double out[3][3]) {
    double angle = fabs(scale) * length(a), first = -0.5 + angle * angle / 24.0, second = 1.0 / 6.0 - angle * angle / 120.0;
    if (!(angle < SMALL_ANGLE))
        first = -2.0 * (sin(0.5 * angle) / angle) * (sin(0.5 * angle) / angle), second = (angle - sin(angle)) / (angle * angle * angle);
    series(a, scale, first, second, out);
}

typedef struct {
    double f[3], omega[3], omega_in[3], half_n[4], half_b[4], middle[4], C[3][3];
} Motion;

/* q turned by half a step: by omega in b, and against omega_in in n */
static void turn(const Motion *o, double *q) {
    product(o->half_n, q, q);
    product(q, o->half_b, q);
}

/* Specific force and rate of the step that begins with `x`, and the attitude in its middle */
static void load_motion(const Model *v, const double *x, const double *u, Motion *o) {
    for (int i = 0; i < 3; i++) {
        o->omega_in[i] = 0.0;
        if (AUGMENTED) {
            o->f[i] = v->decay * x[FORCE + i];
            o->omega[i] = v->decay * x[RATE + i];
        } else {
            o->f[i] = u[i] - x[1 + BA + i];
            o->omega[i] = u[3 + i] - x[1 + BG + i];
            o->omega_in[i] = v->rate[i];
            for (int j = 0; j < 3; j++) o->omega_in[i] += v->transport[i][j] * x[V + j];
        }
    }
    quaternion_exponential(o->omega_in, -0.5 * v->dt, o->half_n);
    quaternion_exponential(o->omega, 0.5 * v->dt, o->half_b);
    memcpy(o->middle, x + Q0, sizeof o->middle);
    turn(o, o->middle);
    dcm(o->middle, o->C);
}

/* 2 omega_ie + omega_en */
static void coriolis_rate(const Model *v, const double *x, double *out) {
    for (int i = 0; i < 3; i++) {
        out[i] = 2.0 * v->rate[i];
        for (int j = 0; j < 3; j++) out[i] += v->transport[i][j] * x[V + j];
    }
}

static void propagate(const Model *v, double *x, const double *u) {
    Motion o;
    double w[3], acceleration[3], dt = v->dt;
    load_motion(v, x, u, &o);
    for (int i = 0; i < 3; i++) acceleration[i] = o.C[i][0] * o.f[0] + o.C[i][1] * o.f[1] + o.C[i][2] * o.f[2];
    coriolis_rate(v, x, w);
    acceleration[0] -= w[1] * x[V + 2] - w[2] * x[V + 1];
    acceleration[1] -= w[2] * x[V] - w[0] * x[V + 2];
    acceleration[2] -= w[0] * x[V + 1] - w[1] * x[V];
    for (int i = 0; i < 3; i++) {
        if (!AUGMENTED) acceleration[i] += v->gravity[i];
        x[POSITION + i] += dt * (x[V + i] + 0.5 * dt * acceleration[i]);
        x[V + i] += dt * acceleration[i];
    }
    turn(&o, o.middle);
    normalise(o.middle);
    memcpy(x + Q0, o.middle, sizeof o.middle);
    if (AUGMENTED)
        for (int i = 0; i < 6; i++) x[FORCE + i] *= v->decay;
}

/* Derivative of the errors of r, v and theta with respect to f and omega; B = exp([omega dt/2 x]), CS = -dt C [f x] */
static void motion_jacobian(const Model *v, const Motion *o, double G[BA][6], double B[3][3], double CS[3][3]) {
    double J[3][3], S[3][3], dt = v->dt;
    dcm_exponential(o->omega, 0.5 * dt, B);
    for (int i = 0; i < 3; i++) {
        CS[i][0] = -dt * (o->C[i][1] * o->f[2] - o->C[i][2] * o->f[1]);
        CS[i][1] = -dt * (o->C[i][2] * o->f[0] - o->C[i][0] * o->f[2]);
        CS[i][2] = -dt * (o->C[i][0] * o->f[1] - o->C[i][1] * o->f[0]);
    }
    right_jacobian(o->omega, 0.5 * dt, J);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) S[i][j] = CS[i][0] * J[0][j] + CS[i][1] * J[1][j] + CS[i][2] * J[2][j];
    right_jacobian(o->omega, dt, J);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            G[V + i][j] = dt * o->C[i][j];
            G[V + i][3 + j] = 0.5 * dt * S[i][j];
            G[POSITION + i][j] = 0.5 * dt * G[V + i][j];
            G[POSITION + i][3 + j] = 0.5 * dt * G[V + i][3 + j];
            G[THETA + i][j] = 0.0;
            G[THETA + i][3 + j] = dt * J[i][j];
        }
}

static void state_jacobian(const Model *v, const Motion *o, const double *x, const double B[3][3], const double CS[3][3], double F[n][n]) {
    double w[3], end[3][3], dt = v->dt;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) end[i][j] = o->C[i][0] * B[0][j] + o->C[i][1] * B[1][j] + o->C[i][2] * B[2][j];
    coriolis_rate(v, x, w);
    F[V][V + 1] = dt * w[2], F[V][V + 2] = -dt * w[1];
    F[V + 1][V] = -dt * w[2], F[V + 1][V + 2] = dt * w[0];
    F[V + 2][V] = dt * w[1], F[V + 2][V + 1] = -dt * w[0];
    for (int j = 0; j < 3; j++) {
        double p = v->transport[0][j], q = v->transport[1][j], r = v->transport[2][j];
        F[V][V + j] += dt * (x[V + 1] * r - x[V + 2] * q);
        F[V + 1][V + j] += dt * (x[V + 2] * p - x[V] * r);
        F[V + 2][V + j] += dt * (x[V] * q - x[V + 1] * p);
    }
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            double total = 0.0, turned = 0.0, transported = 0.0;
            for (int k = 0; k < 3; k++) {
                total += CS[i][k] * B[j][k];
                turned += B[k][i] * B[j][k];
                if (!AUGMENTED) transported += end[k][i] * v->transport[k][j];
            }
            F[V + i][THETA + j] = total;
            F[THETA + i][THETA + j] = turned;
            F[THETA + i][V + j] = -dt * transported;
        }
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            F[POSITION + i][V + j] = 0.5 * dt * F[V + i][V + j];
            F[POSITION + i][THETA + j] = 0.5 * dt * F[V + i][THETA + j];
        }
        F[POSITION + i][V + i] += 0.5 * dt;
    }
}

static void linearise(const Model *v, const double *x, const double *u, double F[n][n], double Q[n][n]) {
    Motion o;
    double G[BA][6], B[3][3], CS[3][3];
    load_motion(v, x, u, &o);
    memset(F, 0, sizeof(double) * n * n);
    memset(Q, 0, sizeof(double) * n * n);
    for (int i = 0; i < n; i++) F[i][i] = 1.0, Q[i][i] = v->noise[i];
    motion_jacobian(v, &o, G, B, CS);
    state_jacobian(v, &o, x, B, CS, F);
    if (!AUGMENTED) {
        for (int i = 0; i < 9; i++)
            for (int j = 0; j < 6; j++) F[i][BA + j] = -G[i][j];
        return;
    }
    for (int j = 0; j < 6; j++) {
        for (int i = 0; i < BA; i++) {
            double moved = G[i][j] * v->transient[j];
            F[i][XF + j] = v->decay * G[i][j];
            Q[i][XF + j] = Q[XF + j][i] = moved;
            for (int k = 0; k <= i; k++) Q[i][k] += moved * G[k][j];
        }
        F[XF + j][XF + j] = v->decay;
        Q[XF + j][XF + j] += v->transient[j];
    }
    for (int i = 0; i < BA; i++)
        for (int k = 0; k < i; k++) Q[k][i] = Q[i][k];
}

/* C^T g, C^T omega_in and, augmented, E = exp([x_omega dt/2 x]) */
static void load_reactions(const Model *v, const double *x, double *reaction, double *rate, double E[3][3]) {
    double C[3][3];
    dcm(x + Q0, C);
    for (int i = 0; i < 3; i++) {
        reaction[i] = rate[i] = 0.0;
        for (int j = 0; j < 3; j++) {
            double turning = v->rate[j];
            for (int k = 0; k < 3; k++) turning += v->transport[j][k] * x[V + k];
            reaction[i] += C[j][i] * v->gravity[j];
            rate[i] += C[j][i] * turning;
        }
    }
    if (AUGMENTED) dcm_exponential(x + RATE, 0.5 * v->dt, E);
}

static void observe(const Model *v, const double *x, const double *u, double *z) {
    double reaction[3], rate[3], E[3][3];
    load_reactions(v, x, reaction, rate, E);
    for (int i = 0; i < 3; i++) {
        z[3 + i] = rate[i] + x[1 + BG + i];
        z[i] = x[1 + BA + i];
        if (AUGMENTED) {
            z[3 + i] += x[RATE + i];
            z[i] += x[FORCE + i];
            for (int j = 0; j < 3; j++) z[i] -= E[i][j] * reaction[j];
        } else
            z[i] -= reaction[i];
    }
}

static void cross(const double *a, double scale, double out[3][3]) {
    out[0][0] = out[1][1] = out[2][2] = 0.0;
    out[0][1] = -scale * a[2], out[1][0] = scale * a[2];
    out[0][2] = scale * a[1], out[2][0] = -scale * a[1];
    out[1][2] = -scale * a[0], out[2][1] = scale * a[0];
}

static void linearise_observation(const Model *v, const double *x, const double *u, double H[m][n]) {
    double reaction[3], rate[3], E[3][3], work[3][3], turned[3][3], J[3][3];
    memset(H, 0, sizeof(double) * m * n);
    for (int i = 0; i < m; i++) H[i][BA + i] = 1.0;
    load_reactions(v, x, reaction, rate, E);
    cross(reaction, -1.0, work);
    if (AUGMENTED) {
        right_jacobian(x + RATE, 0.5 * v->dt, J);
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++) turned[i][j] = E[i][0] * work[0][j] + E[i][1] * work[1][j] + E[i][2] * work[2][j];
        for (int i = 0; i < 3; i++) {
            H[i][XF + i] = H[3 + i][XW + i] = 1.0;
            for (int j = 0; j < 3; j++) {
                H[i][THETA + j] = turned[i][j];
                for (int k = 0; k < 3; k++) H[i][XW + j] -= 0.5 * v->dt * turned[i][k] * J[k][j];
            }
        }
    } else
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++) H[i][THETA + j] = work[i][j];
    cross(rate, 1.0, work);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) H[3 + i][THETA + j] = work[i][j];
}

static void retract(const Model *v, double *x, const double *error) {
    double turned[4];
    for (int i = 0; i < 6; i++) x[i] += error[i];
    quaternion_exponential(error + THETA, 1.0, turned);
    product(x + Q0, turned, x + Q0);
    normalise(x + Q0);
    for (int i = BA; i < n; i++) x[i + 1] += error[i];
}
