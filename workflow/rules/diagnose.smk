# Noise diagnostics of a scenario's synthetic residuals.


rule diagnose:
    input:
        lambda wildcards: LAYOUT.outputs(PAPERS[wildcards.paper], wildcards.job),
    output:
        f"{LAYOUT.build}/{{paper}}/diagnose/{{job}}.parquet",
    params:
        paper="{paper}",
        source=lambda wildcards: SOURCES[wildcards.paper].result(
            pipeline.DIAGNOSE + wildcards.job
        ),
    log:
        f"{LAYOUT.build}/logs/{{paper}}/diagnose/{{job}}.log",
    conda:
        "../envs/robins.yaml"
    script:
        "../scripts/diagnose.py"
