"""Hajiyev & Hacizade (2023): a covariance-matching adaptive measurement-differencing Kalman filter for INS errors.

WSEAS Transactions on Systems and Control 18, 478-486, doi 10.37394/23203.2023.18.51 (CC BY 4.0).

``scenario`` and ``ensemble``: section 5; ``estimators`` and ``as_printed``: sections 3 and 4; ``studies``: what
the brief asks beyond the paper; ``tables``, ``figures``, ``claims``, ``register``: what is published.
"""
