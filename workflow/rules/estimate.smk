# Variants (filters) and studies (sweeps, theory): one job each, over the whole ensemble, after the jobs that it needs.


rule estimate:
    input:
        lambda wildcards: LAYOUT.inputs(
            PAPERS[wildcards.paper], [PAPERS[wildcards.paper].jobs[wildcards.job]]
        ),
    output:
        f"{LAYOUT.build}/{{paper}}/estimate/{{job}}.parquet",
        f"{LAYOUT.build}/{{paper}}/estimate/{{job}}.npz",
    params:
        paper="{paper}",
        source=lambda wildcards: SOURCES[wildcards.paper].result(wildcards.job),
    log:
        f"{LAYOUT.build}/logs/{{paper}}/estimate/{{job}}.log",
    benchmark:
        f"{LAYOUT.build}/benchmarks/{{paper}}/{{job}}.tsv"
    conda:
        "../envs/robins.yaml"
    script:
        "../scripts/compute.py"
