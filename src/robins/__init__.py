"""robins: robust inertial navigation, replicated.

Conventions, stated once and used everywhere
--------------------------------------------
Units    SI and radians. Degrees, kilometres and degrees per hour exist only where a configuration
         is loaded and where a table or a figure is published.
Frames   ``n`` east-north-up navigation frame unless a module says otherwise; ``b`` body frame, each
         model states its axes; a suffix names the frame of a vector (``specific_force_b``).
Arrays   time first, then channel: ``(N,)``, ``(N, n)``; ensembles ``(runs, N, n)``; float64, C order.
Symbols  ``x`` state, ``P`` its covariance, ``F`` transition Jacobian, ``Q`` process noise covariance,
         ``z`` measurement, ``H`` its Jacobian, ``R`` its noise covariance, ``K`` gain,
         ``S`` innovation covariance, ``w`` weights in [0, 1].
Noise    every random number comes from a named stream (`robins.foundation.randomness`).

The compiled kernels are cached on disk; the line below has to run before anything is compiled.
"""

from robins import compile_cache

compile_cache.activate()

__version__ = "0.1.0"
